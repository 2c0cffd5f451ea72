// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace mebots::soc::gap8_devices {

/// Models a HyperFlash. A write of a 16-bit word is part of an unlock sequence, a command, or data of a command. A
/// command to program or erase needs unlock words before it. Programming changes ones to zeros within a line; erasing
/// sets a whole sector to ones. Both take no time. Source of the commands: GreenWaves' gap_sdk, hyperflash.c.
class HyperFlash {
 public:
  static constexpr std::uint32_t kBytes = 64U << 20;         // size of the GAPuino's S71KS512S
  static constexpr std::uint32_t kSectorBytes = 256U << 10;  // size of a sector of the S71KS512S
  static constexpr std::uint32_t kLineBytes = 512;           // maximum size of the data of one program command

  /// The flash initially contains `image`, followed by ones. `image` must outlive this object.
  explicit HyperFlash(std::span<const std::uint8_t> image) : image_(image) {}
  void set_image(std::span<const std::uint8_t> image);

  /// Writes bytes, all of which must be inside the flash. If a command is unknown, returns false and waits for the next
  /// unlock sequence.
  bool write(std::uint32_t place, std::span<const std::uint8_t> bytes);
  void read(std::uint32_t place, std::span<std::uint8_t> bytes);

  void visit(state::Visitor& v);

 private:
  /// Meaning of the next word that is written to the flash.
  enum class Expects : std::uint32_t { unlock, second_unlock, command, erase_unlock, second_erase_unlock, erase, data };
  /// Contents of a sector that differs from the image.
  struct Sector {
    std::uint32_t place = 0;
    std::vector<std::uint8_t> bytes;

    void visit(state::Visitor& v) {
      v("place", place);
      v("bytes", bytes);
    }
  };

  bool obey(std::uint32_t place, std::uint32_t word);
  bool expect(bool good, Expects next);
  bool program(std::uint32_t place, std::span<const std::uint8_t> bytes);
  bool erase(std::uint32_t place);
  bool erase_all();
  Sector& sector_at(std::uint32_t place);
  void read_image(std::uint32_t place, std::span<std::uint8_t> bytes) const;

  std::span<const std::uint8_t> image_;
  Expects expects_ = Expects::unlock;
  bool shows_status_ = false;    // the next read returns the status instead of data
  std::vector<Sector> changed_;  // sorted by address
};

}  // namespace mebots::soc::gap8_devices
