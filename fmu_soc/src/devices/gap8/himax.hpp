// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/core/attached_part.hpp"
#include "mebots/soc/time.hpp"
#include "mebots/state/visitor.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace mebots::soc::gap8_devices {

/// Interface of a device on an I2C bus. The model of the bus master calls the functions of this interface.
class I2cDevice {
 public:
  virtual ~I2cDevice() = default;
  /// Returns the device's address on the bus, seven bits.
  virtual std::uint8_t address() const = 0;
  virtual void start() = 0;
  virtual void write(std::uint8_t byte, Picoseconds now) = 0;
  virtual std::uint8_t read() = 0;
};

/// Window, step and orientation of a frame.
struct FrameFormat {
  std::uint32_t window_height = 0;  // rows of the array
  std::uint32_t row_step = 1;       // 2: every second row
  std::uint32_t column_step = 1;
  std::uint32_t binning = 0;
  std::uint32_t orientation = 0;

  /// Size of a frame at the output.
  std::uint32_t width() const;
  std::uint32_t height() const { return window_height / row_step; }
  /// Copies the pixels of a frame in the order of the output. The picture must have Himax::kWidth columns and at least
  /// window_height rows; the rows in the middle are used.
  void read_out(std::span<const std::uint8_t> picture, std::vector<std::uint8_t>& pixels) const;

  void visit(state::Visitor& v);
};

/// HM01B0, the camera of AI-deck and GAPuino. It has 8-bit registers at 16-bit addresses over I2C, and sends frames in
/// the mode that MODE_SELECT sets. These registers have an effect:
///
///   0x0100 mode                  0x0340 lines of a frame                    0x0390 binning: bit 0 rows, bit 1 columns
///   0x0101 orientation           0x0342 pixel clocks of a line              0x3010 window of 244 lines, not 324
///   0x0103 reset                 0x0383, 0x0387 every second column, row (3) 0x3020 frames of mode 3
///   0x0202 lines of integration
///
/// In mode 1, frames follow each other until mode 0 is set. We assume that mode 0 acts at once: a frame in progress is
/// lost. A reset also enters standby. In mode 3, the sensor takes the number of frames in register 0x3020 (0 means one
/// frame, which is assumed). Then it enters standby. The rows of the first frame are read out after their exposure;
/// waking up takes no time (assumed). If mode 3 is set during mode 1, the first counted frame is the next one that
/// begins at least one integration time later.
///
/// Lines and clocks determine the frame rate (docs/chip/gap8-camera.md lists the highest rates). If a frame has fewer
/// lines than rows, each row takes a line. Gain and integration do not change a picture.
///
/// Sources: register names in the driver of GreenWaves' gap_sdk (himax.c); formats, minimum lines and clocks, and the
/// clock of 6 MHz in idsia-robotics/nanocockpit (himax.c, himax_supported_framerates.md); mode 3 and 0x3020 in the
/// driver of TensorFlow Lite Micro's person detection (apollo3evb, HM01B0.c).
class Himax final : public I2cDevice {
 public:
  static constexpr std::uint32_t kWidth = 324;
  static constexpr std::uint32_t kHeight = 324;
  static constexpr std::uint32_t kWindowHeight = 244;

  /// `port` connects the part of the board that models the camera's energy. The part is active while the camera
  /// streams.
  explicit Himax(PartPort port = {}) : port_(port) { reset(); }

  std::uint8_t address() const override { return 0x24; }
  void start() override { address_bytes_ = 0; }
  void write(std::uint8_t byte, Picoseconds now) override;
  std::uint8_t read() override;

  bool streams() const { return streams_; }
  /// Returns the start of read-out of the first frame at or after `time`; kNever if there is none. Must be called only
  /// while the camera streams.
  Picoseconds frame_at(Picoseconds time) const;
  /// Returns the time at which the camera enters standby without a command.
  Picoseconds next_event() const { return streams_ ? ends_at_ : kNever; }
  void advance(Picoseconds now);
  /// Returns the time from the start of a frame to the end of this many lines.
  Picoseconds lines_time(std::uint32_t lines) const;
  /// Returns the start of read-out of the first frame of the present stream. Each standby ends a stream. Must be called
  /// only while the camera streams.
  Picoseconds first_frame_at() const { return first_at_; }
  /// Returns the integration time of each line.
  Picoseconds exposure_time() const;
  /// Returns the format of a frame that begins now.
  FrameFormat format() const;

  void visit(state::Visitor& v);

 private:
  static constexpr std::size_t kRegisters = 0x4000;

  void reset();
  void select_mode(std::uint32_t mode, Picoseconds now);
  void stand_by(Picoseconds now);
  /// Returns the time from one frame to the next.
  Picoseconds period() const;
  Picoseconds frame_after(Picoseconds time) const;
  std::uint8_t reg(std::size_t at) const { return registers_[at]; }
  std::uint32_t pair(std::size_t at) const { return std::uint32_t{reg(at)} << 8 | reg(at + 1); }

  PartPort port_;
  std::vector<std::uint8_t> registers_;
  std::uint32_t at_ = 0;             // next register
  std::uint32_t address_bytes_ = 0;  // bytes of the address received since the start condition
  bool streams_ = false;
  Picoseconds first_at_ = 0;      // first frame of the stream
  Picoseconds ends_at_ = kNever;  // last frame of the stream
};

}  // namespace mebots::soc::gap8_devices
