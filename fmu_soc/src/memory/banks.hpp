// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

namespace mebots::soc {

/// Which cycles of the banks of a shared memory are taken, over a window of kWindow cycles that moves with time.
/// A bank serves one word per cycle; consecutive words lie in consecutive banks.
class Banks {
 public:
  static constexpr unsigned kMost = 32;
  /// Wide enough for eight cores that each run a block of 64 accesses past the end of their quantum.
  static constexpr std::uint64_t kWindow = 1024;
  /// Ticks from the window's start on that can be taken.
  static constexpr std::uint32_t kReach = kWindow - 64;
  static constexpr std::uint32_t kBytesPerBank = kWindow / 8;

  /// `count` must be a power of two, at most kMost.
  explicit Banks(unsigned count = 16) : mask_(count - 1) {}

  /// Takes the first free cycle of the bank at or after `tick`; the answer is how long to wait for it. A tick before
  /// the window counts as its start; behind the window nobody is in the way.
  std::uint32_t claim(std::uint64_t tick, std::uint32_t address) {
    auto& bank = busy_[address / 4 & mask_];
    const auto end = start_ + kReach;
    for (auto at = tick < start_ ? start_ : tick; at < end; at = (at | 63U) + 1) {
      auto& word = bank[at / 64 % kWords];
      const auto free = ~word >> (at & 63U);
      if (free == 0) continue;
      const auto slot = at + static_cast<unsigned>(std::countr_zero(free));
      word |= std::uint64_t{1} << (slot & 63U);
      return static_cast<std::uint32_t>(slot - tick);
    }
    return tick < end ? static_cast<std::uint32_t>(end - tick) : 0;
  }

  /// The window starts at `tick` from now on; ticks do not go back.
  void move_to(std::uint64_t tick) {
    const auto last = std::min(tick / 64, start_ / 64 + kWords);
    for (auto word = start_ / 64; word < last; ++word) {
      for (auto& bank : busy_) bank[word % kWords] = 0;
    }
    start_ = tick;
  }

  std::uint64_t start() const { return start_; }

  /// For translated code: kBytesPerBank bytes of each bank in turn, bit `tick % kWindow` of them for each tick.
  std::uint64_t* taken() { return busy_.front().data(); }

 private:
  static constexpr std::uint64_t kWords = kWindow / 64;

  std::uint64_t start_ = 0;
  std::array<std::array<std::uint64_t, kWords>, kMost> busy_{};  // by tick / 64, round and round; a bit set = taken
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
  std::uint32_t claim_at(std::uint64_t tick, std::uint32_t address) { return banks_->claim(tick, address); }

  std::uint64_t tick_of(std::uint64_t cycle) const { return cycle + offset_; }
  Banks& banks() { return *banks_; }

 private:
  Banks* banks_;
  std::uint64_t offset_ = 0;
};

}  // namespace mebots::soc
