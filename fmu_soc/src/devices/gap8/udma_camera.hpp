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

/// How the camera interface is set for a frame: its registers.
struct InterfaceSettings {
  std::uint32_t global = 0;
  std::uint32_t lower_left = 0;
  std::uint32_t upper_right = 0;
  std::uint32_t filter = 0;

  void visit(state::Visitor& v);
};

/// The camera interface (CPI) of the uDMA with an HM01B0. A transfer takes the next frame that begins while interface
/// and camera are on, line after line, and ends with the last line of its window. If one of them goes off before that,
/// the frame is lost, and the transfer takes the next one. A frame has the format and the lines with which it began.
/// Dropping frames is not modelled, and told.
///
/// When the frame's first row begins to gather light, its picture is asked for, from the roll or from the world. The
/// world's comes later than that, and in time for the last line: bytes move at the transfer's end. Where it does not,
/// because steps are long, the transfer ends when it comes.
///
/// Its variables are those of the entry: camera.frame, .frame_id, .frame.base64, .frame_width and .frame_height go in,
/// camera.trigger goes out, as of MEbots' own camera. A picture of the world's of another size ends the run; rows are
/// Himax::kWidth columns. Source of registers: archi/udma/cpi/udma_cpi_v1.h.
class UdmaCamera final : public UdmaPeripheral {
 public:
  UdmaCamera(UdmaHost& host, Himax& sensor, const PictureRoll& roll);

  Picoseconds end_time(const UdmaTransfer& transfer, Picoseconds start) override;
  void end(const UdmaTransfer& transfer) override;
  void cancel(const UdmaTransfer& transfer, Picoseconds now) override;
  /// When the frame begins that a transfer waits for, or when it ends.
  Picoseconds next_event() const;
  void advance(Picoseconds now);
  void registers_changed(std::uint32_t offset, Picoseconds now) override;

  double* input(std::string_view variable) override;
  std::string_view* text_input(std::string_view variable) override;
  std::span<const std::uint8_t>* bytes_input(std::string_view variable) override;
  const double* output(std::string_view variable) const override;
  void begin_step(Picoseconds now) override;
  /// With a roll: one that it has not.
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
  // Of the transfer that runs; kNever = there is none, or not yet.
  Picoseconds requested_at_ = kNever;
  Picoseconds frame_at_ = kNever;
  Picoseconds light_at_ = kNever;
  Picoseconds ends_at_ = kNever;
  Picoseconds first_frame_at_ = kNever;  // the sensor's first frame since it streams: another one behind a standby
  // As the frame began: its picture may come behind later settings.
  FrameFormat format_;
  InterfaceSettings interface_;
  bool waits_ = false;  // for its picture
  bool has_picture_ = false;
  Picoseconds arrived_at_ = 0;
  std::vector<std::uint8_t> picture_;  // as it came
  std::vector<std::uint8_t> pixels_;   // of the frame; not kept
  std::vector<std::uint8_t> stream_;   // what goes to memory; not kept

  // Variables.
  double frame_id_ = 0;
  double frame_width_ = Himax::kWidth;
  double frame_height_ = 0;  // any
  double trigger_ = 0;
  std::span<const std::uint8_t> frame_;
  std::string_view frame_base64_;
  std::vector<std::uint8_t> decoded_;
};

}  // namespace mebots::soc::gap8_devices
