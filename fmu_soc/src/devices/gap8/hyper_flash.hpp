// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace mebots::soc::gap8_devices {

/// A HyperFlash as its driver sees it: words of 16 bits that are written are commands, each behind an unlocking pair of
/// them, or what one of them programs. Programming makes ones zeros, within a line; erasing makes a sector all ones. It
/// is ready at once: how long silicon takes is not modelled. Source of the commands: GreenWaves' gap_sdk, hyperflash.c.
class HyperFlash {
 public:
  static constexpr std::uint32_t kBytes = 64U << 20;         // of a GAPuino's S71KS512S
  static constexpr std::uint32_t kSectorBytes = 256U << 10;  // likewise
  static constexpr std::uint32_t kLineBytes = 512;           // that one command programs

  /// It begins with `image`, all ones behind it, which must stay where it is.
  explicit HyperFlash(std::span<const std::uint8_t> image) : image_(image) {}
  /// Another image, in place of all that it holds.
  void set_image(std::span<const std::uint8_t> image);

  /// All bytes must lie inside. False: nothing that it knows; it has forgotten what came before.
  bool write(std::uint32_t place, std::span<const std::uint8_t> bytes);
  void read(std::uint32_t place, std::span<std::uint8_t> bytes);

  void visit(state::Visitor& v);

 private:
  /// What the next write is taken for.
  enum class Expects : std::uint32_t { unlock, second_unlock, command, erase_unlock, second_erase_unlock, erase, data };
  /// One that is not as the image has it.
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
  bool shows_status_ = false;    // to the next read
  std::vector<Sector> changed_;  // by place
};

}  // namespace mebots::soc::gap8_devices
