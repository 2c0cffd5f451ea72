// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/core/chip_host.hpp"
#include "devices/gap8/himax.hpp"
#include "devices/gap8/udma_peripheral.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace mebots::soc::gap8_devices {

struct InterfaceSettings {
  std::uint32_t global = 0;
  std::uint32_t lower_left = 0;
  std::uint32_t upper_right = 0;
  std::uint32_t filter = 0;

  void visit(state::Visitor& v);
};

/// Models the camera interface (CPI) of the uDMA with an HM01B0. A transfer takes the next frame that begins while
/// interface and camera are on, and ends with the last line of the frame's window. If the interface or the camera is
/// switched off before the transfer ends, the frame is lost, and the transfer takes the next frame. The settings at the
/// start of a frame determine its format and lines. Dropping of frames by the interface is not modelled; a program that
/// uses it is reported.
///
/// When the exposure of the first row starts, the picture is requested from the picture roll or from the world. A
/// picture of the world arrives later, usually before the last line, and is copied at the end of the transfer. If the
/// picture arrives after the last line, because steps are long, the transfer ends at its arrival.
///
/// Inputs are camera.frame, .frame_id, .frame.base64, .frame_width and .frame_height; the output is camera.trigger, as
/// for MEbots' own camera. A picture of another size ends the run. Rows have Himax::kWidth columns. Source of
/// registers: archi/udma/cpi/udma_cpi_v1.h.
class UdmaCamera final : public UdmaPeripheral {
 public:
  UdmaCamera(UdmaHost& host, Himax& sensor, const PictureRoll& roll);

  Picoseconds end_time(const UdmaTransfer& transfer, Picoseconds start) override;
  void end(const UdmaTransfer& transfer) override;
  void cancel(const UdmaTransfer& transfer, Picoseconds now) override;
  /// Returns the start of the exposure of the transfer's frame or, after the picture has arrived, the end of the
  /// transfer. If there is no frame yet, or while the device waits for the picture, returns kNever.
  Picoseconds next_event() const;
  void advance(Picoseconds now);
  void registers_changed(std::uint32_t offset, Picoseconds now) override;

  double* input(std::string_view variable) override;
  std::string_view* text_input(std::string_view variable) override;
  std::span<const std::uint8_t>* bytes_input(std::string_view variable) override;
  const double* output(std::string_view variable) const override;
  void begin_step(Picoseconds now) override;
  /// Returns true while a transfer of the camera's channel runs. On a board with a picture roll, returns true while a
  /// transfer waits although the roll has no picture left.
  bool takes_picture() const override { return roll_.exists() ? waits_ : requested_at_ != kNever; }

  void visit(state::Visitor& v) override;

 private:
  bool is_on() const;
  InterfaceSettings interface_settings() const;
  void expose(Picoseconds now);
  void take(std::span<const std::uint8_t> picture, Picoseconds now);
  void convert();
  std::uint32_t converted(std::uint32_t first, std::uint32_t second) const;
  void forget();
  void lose_frame();
  Picoseconds stored_at() const { return std::max(arrived_at_, ends_at_); }
  void require_parameters() const;
  void require_size(std::size_t bytes) const;
  void require_rows(std::size_t bytes) const;
  Picoseconds end_of_frame() const;

  UdmaHost& host_;
  Himax& sensor_;
  const PictureRoll& roll_;
  std::int32_t requests_ = 0;
  // Times of the running transfer; kNever if there is no transfer or the time is not known yet.
  Picoseconds requested_at_ = kNever;
  Picoseconds frame_at_ = kNever;
  Picoseconds light_at_ = kNever;
  Picoseconds ends_at_ = kNever;
  /// Start of the first frame in the sensor's stream; each standby ends a stream.
  Picoseconds first_frame_at_ = kNever;
  // Settings at the start of the frame. The registers may change before the picture of the frame arrives.
  FrameFormat format_;
  InterfaceSettings interface_;
  bool waits_ = false;  // true while the transfer waits for its picture
  bool has_picture_ = false;
  Picoseconds arrived_at_ = 0;
  std::vector<std::uint8_t> picture_;  // picture that the roll or the world has sent
  std::vector<std::uint8_t> pixels_;   // pixels of the frame; not part of a state
  std::vector<std::uint8_t> stream_;   // bytes to copy to memory; not part of a state

  // Variables of the FMU.
  double frame_id_ = 0;
  double frame_width_ = Himax::kWidth;
  double frame_height_ = 0;  // 0 = any height
  double trigger_ = 0;
  std::span<const std::uint8_t> frame_;
  std::string_view frame_base64_;
  std::vector<std::uint8_t> decoded_;
};

}  // namespace mebots::soc::gap8_devices
