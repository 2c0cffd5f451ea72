// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace mebots::soc {

/// Which cycles of the banks of a shared memory are taken, over a window of kWindow cycles that moves with time.
/// A bank serves one word per cycle; consecutive words lie in consecutive banks.
class Banks {
 public:
  static constexpr unsigned kMost = 32;
  static constexpr unsigned kWindow = 128;

  /// `count` must be a power of two, at most kMost.
  explicit Banks(unsigned count = 16) : mask_(count - 1) {}

  /// Takes the first free cycle of the bank at or after `tick`; the answer is how long to wait for it. A tick before
  /// the window counts as its start; behind the window nobody is in the way.
  std::uint32_t claim(std::uint64_t tick, std::uint32_t address) {
    const auto position = tick < start_ ? 0 : tick - start_;
    if (position >= kWindow) return 0;
    auto& bank = busy_[address / 4 & mask_];
    auto at = static_cast<unsigned>(position);
    if (at < 64) {
      const auto free = ~bank[0] >> at;
      if (free != 0) {
        const auto wait = static_cast<unsigned>(std::countr_zero(free));
        bank[0] |= std::uint64_t{1} << (at + wait);
        return wait;
      }
      at = 64;
    }
    const auto free = ~bank[1] >> (at - 64);
    const auto slot = free == 0 ? kWindow : at + static_cast<unsigned>(std::countr_zero(free));
    if (slot < kWindow) bank[1] |= std::uint64_t{1} << (slot - 64);
    return slot - static_cast<unsigned>(position);
  }

  /// The window starts at `tick` from now on; ticks do not go back.
  void move_to(std::uint64_t tick) {
    const auto steps = tick - start_;
    start_ = tick;
    for (auto& bank : busy_) {
      if (steps >= kWindow) {
        bank = {};
      } else if (steps >= 64) {
        bank = {bank[1] >> (steps - 64), 0};
      } else if (steps > 0) {
        bank = {bank[0] >> steps | bank[1] << (64 - steps), bank[1] >> steps};
      }
    }
  }

  std::uint64_t start() const { return start_; }

 private:
  std::uint64_t start_ = 0;
  std::array<std::array<std::uint64_t, 2>, kMost> busy_{};
  std::uint64_t mask_;
};

/// Banks as one core sees them: it counts its own active cycles.
class BankSchedule {
 public:
  explicit BankSchedule(Banks& banks) : banks_(&banks) {}

  /// Active cycle `cycle` of the core is tick `cycle + offset` of the banks (modulo 2^64).
  void set_offset(std::uint64_t offset) { offset_ = offset; }

  /// Extra cycles of an access in active cycle `cycle`.
  std::uint32_t claim(std::uint64_t cycle, std::uint32_t address) { return banks_->claim(cycle + offset_, address); }

 private:
  Banks* banks_;
  std::uint64_t offset_ = 0;
};

}  // namespace mebots::soc
