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

/// A chip on an I2C bus, as the bus sees it.
class I2cDevice {
 public:
  virtual ~I2cDevice() = default;
  /// Seven bits.
  virtual std::uint8_t address() const = 0;
  virtual void start() = 0;
  virtual void write(std::uint8_t byte, Picoseconds now) = 0;
  virtual std::uint8_t read() = 0;
};

/// What of the array a frame shows, and how.
struct FrameFormat {
  std::uint32_t window_height = 0;  // rows of the array
  std::uint32_t row_step = 1;       // 2: every second one
  std::uint32_t column_step = 1;
  std::uint32_t binning = 0;
  std::uint32_t orientation = 0;

  /// Of a frame as it comes out.
  std::uint32_t width() const;
  std::uint32_t height() const { return window_height / row_step; }
  /// The pixels of a frame in the order in which they come out. The picture has Himax::kWidth columns and at least
  /// window_height rows, of which those in the middle are taken.
  void read_out(std::span<const std::uint8_t> picture, std::vector<std::uint8_t>& pixels) const;

  void visit(state::Visitor& v);
};

/// HM01B0, the AI-deck's and the GAPuino's camera, as a driver sees it: 8-bit registers at 16-bit addresses by I2C,
/// which keep what is stored, and frames as MODE_SELECT says. Of the registers these do something:
///
///   0x0100 mode                  0x0340 lines of a frame                    0x0390 binning: bit 0 rows, bit 1 columns
///   0x0101 orientation           0x0342 pixel clocks of a line              0x3010 window of 244 lines, not 324
///   0x0103 reset                 0x0383, 0x0387 every second column, row (3) 0x3020 frames of mode 3
///   0x0202 lines of integration
///
/// In mode 1 a frame follows another until mode 0, which is assumed to be obeyed at once: a frame under way is lost. A
/// reset is standby, too.
/// In mode 3 the sensor takes as many frames as 0x3020 says (0: one, assumed), and then goes to standby. The rows of
/// the first frame are read out when they are exposed; waking up takes no time (assumed). If mode 3 is set during mode
/// 1, the count starts with the next frame that begins an integration later.
///
/// Lines and clocks set the frame rate (docs/chip/gap8-camera.md has the highest rates). A frame with fewer lines than
/// rows takes a line for each row. Gain and integration do not change a picture.
///
/// Sources: register names in the driver of GreenWaves' gap_sdk (himax.c); formats, least lines and clocks, and the
/// clock of 6 MHz in idsia-robotics/nanocockpit (himax.c, himax_supported_framerates.md); mode 3 and 0x3020 in the
/// driver of TensorFlow Lite Micro's person detection (apollo3evb, HM01B0.c).
class Himax final : public I2cDevice {
 public:
  static constexpr std::uint32_t kWidth = 324;
  static constexpr std::uint32_t kHeight = 324;
  static constexpr std::uint32_t kWindowHeight = 244;

  /// `port`: the part of the board that consumes as the camera does; active while it streams.
  explicit Himax(PartPort port = {}) : port_(port) { reset(); }

  std::uint8_t address() const override { return 0x24; }
  void start() override { address_bytes_ = 0; }
  void write(std::uint8_t byte, Picoseconds now) override;
  std::uint8_t read() override;

  bool streams() const { return streams_; }
  /// When the first frame begins to be read out that does so at or after `time`; kNever: none does. While it streams.
  Picoseconds frame_at(Picoseconds time) const;
  /// When it goes to standby by itself.
  Picoseconds next_event() const { return streams_ ? ends_at_ : kNever; }
  void advance(Picoseconds now);
  /// From a frame's begin up to the end of so many lines.
  Picoseconds lines_time(std::uint32_t lines) const;
  /// When the first frame since it streams begins to be read out: another one behind every standby. While it streams.
  Picoseconds first_frame_at() const { return first_at_; }
  /// How long each line gathers light.
  Picoseconds exposure_time() const;
  /// Of a frame that begins now.
  FrameFormat format() const;

  void visit(state::Visitor& v);

 private:
  static constexpr std::size_t kRegisters = 0x4000;

  void reset();
  void select_mode(std::uint32_t mode, Picoseconds now);
  void stand_by(Picoseconds now);
  /// From a frame's begin to that of the next.
  Picoseconds period() const;
  Picoseconds frame_after(Picoseconds time) const;
  std::uint8_t reg(std::size_t at) const { return registers_[at]; }
  std::uint32_t pair(std::size_t at) const { return std::uint32_t{reg(at)} << 8 | reg(at + 1); }

  PartPort port_;
  std::vector<std::uint8_t> registers_;
  std::uint32_t at_ = 0;             // the register that is next
  std::uint32_t address_bytes_ = 0;  // that have come since the start
  bool streams_ = false;
  Picoseconds first_at_ = 0;      // frame since it streams
  Picoseconds ends_at_ = kNever;  // the last one
};

}  // namespace mebots::soc::gap8_devices
