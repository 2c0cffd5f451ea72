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

/// A device on an I2C bus. The model of the bus master calls these functions.
class I2cDevice {
 public:
  virtual ~I2cDevice() = default;
  /// Returns the seven-bit address of the device on the bus.
  virtual std::uint8_t address() const = 0;
  virtual void start() = 0;
  virtual void write(std::uint8_t byte, Picoseconds now) = 0;
  virtual std::uint8_t read() = 0;
};

struct FrameFormat {
  std::uint32_t window_height = 0;  // number of rows in the window of the sensor array
  std::uint32_t row_step = 1;       // 1: every row is read out; 2: every second row
  std::uint32_t column_step = 1;
  std::uint32_t binning = 0;
  std::uint32_t orientation = 0;

  /// Return the size of the frames that the sensor sends [px].
  std::uint32_t width() const;
  std::uint32_t height() const { return window_height / row_step; }
  /// Copies the pixels of a frame in the order of the output. The picture must have Himax::kWidth columns and at least
  /// window_height rows. If it has more rows, the rows in the middle are used.
  void read_out(std::span<const std::uint8_t> picture, std::vector<std::uint8_t>& pixels) const;

  void visit(state::Visitor& v);
};

/// Models the HM01B0, the camera of AI-deck and GAPuino. It has 8-bit registers at 16-bit addresses over I2C, and sends
/// frames in the mode that MODE_SELECT sets. These registers have an effect:
///
///   0x0100 mode                  0x0340 lines of a frame                    0x0390 binning: bit 0 rows, bit 1 columns
///   0x0101 orientation           0x0342 pixel clocks of a line              0x3010 window of 244 lines, not 324
///   0x0103 reset                 0x0383, 0x0387 every second column, row (3) 0x3020 frames of mode 3
///   0x0202 lines of integration
///
/// In mode 1, frames follow each other until mode 0 is set. We assume that mode 0 acts at once: a frame in progress is
/// lost. A reset also enters standby. In mode 3, the sensor takes the number of frames in register 0x3020 (we assume
/// that 0 means one frame), and then enters standby. The rows of the first frame are read out after their exposure; we
/// assume that waking up takes no time. If mode 3 is set during mode 1, the first counted frame is the next one that
/// begins at least one integration time later.
///
/// Lines and clocks determine the frame rate (docs/chip/gap8-camera.md lists the highest rates). A frame has at least
/// one line per row. Gain and integration do not change a picture.
///
/// Sources: register names in the driver of GreenWaves' gap_sdk (himax.c); formats, minimum lines and clocks, and the
/// clock of 6 MHz in idsia-robotics/nanocockpit (himax.c, himax_supported_framerates.md); mode 3 and 0x3020 in the
/// driver of TensorFlow Lite Micro's person detection (apollo3evb, HM01B0.c).
class Himax final : public I2cDevice {
 public:
  static constexpr std::uint32_t kWidth = 324;
  static constexpr std::uint32_t kHeight = 324;
  static constexpr std::uint32_t kWindowHeight = 244;

  /// `port` connects the part of the board that models the camera's energy.
  explicit Himax(PartPort port = {}) : port_(port) { reset(); }

  std::uint8_t address() const override { return 0x24; }
  void start() override { address_bytes_ = 0; }
  void write(std::uint8_t byte, Picoseconds now) override;
  std::uint8_t read() override;

  bool streams() const { return streams_; }
  /// Returns the time at which the read-out of the first frame at or after `time` starts, or kNever if there is no such
  /// frame. Must be called only while the camera streams.
  Picoseconds frame_at(Picoseconds time) const;
  /// Returns the time at which the camera enters standby after the last frame of mode 3, or kNever if it does not.
  Picoseconds next_event() const { return streams_ ? ends_at_ : kNever; }
  void advance(Picoseconds now);
  /// Returns the time from the start of a frame to the end of its first `lines` lines.
  Picoseconds lines_time(std::uint32_t lines) const;
  /// Returns the time at which the read-out of the stream's first frame starts. Each standby ends a stream. Must be
  /// called only while the camera streams.
  Picoseconds first_frame_at() const { return first_at_; }
  Picoseconds exposure_time() const;
  /// Returns the format of a frame that starts now.
  FrameFormat format() const;

  void visit(state::Visitor& v);

 private:
  static constexpr std::size_t kRegisters = 0x4000;

  void reset();
  void select_mode(std::uint32_t mode, Picoseconds now);
  void stand_by(Picoseconds now);
  /// Returns the time from the start of one frame to the start of the next.
  Picoseconds period() const;
  Picoseconds frame_after(Picoseconds time) const;
  std::uint8_t reg(std::size_t at) const { return registers_[at]; }
  std::uint32_t pair(std::size_t at) const { return std::uint32_t{reg(at)} << 8 | reg(at + 1); }

  PartPort port_;
  std::vector<std::uint8_t> registers_;
  std::uint32_t at_ = 0;             // address of the register that is accessed next
  std::uint32_t address_bytes_ = 0;  // address bytes received since the start condition
  bool streams_ = false;
  Picoseconds first_at_ = 0;      // start of the stream's first frame
  Picoseconds ends_at_ = kNever;  // time at which the stream ends without a command; kNever = never
};

}  // namespace mebots::soc::gap8_devices
