// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/bytes.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace mebots::soc {

/// Which cycles of the banks of a shared memory are taken, over a window of kReach cycles that moves with time.
/// A bank serves one word per cycle; consecutive words lie in consecutive banks.
class Banks {
 public:
  static constexpr unsigned kMost = 32;
  /// Wide enough for eight cores that each run a block of 64 accesses past the end of their quantum.
  static constexpr std::uint64_t kWindow = 1024;
  /// Ticks from the window's start on that can be taken.
  static constexpr std::uint32_t kReach = kWindow - 64;

  /// `count` must be a power of two, at most kMost.
  explicit Banks(unsigned count = 16) : count_(count), taken_(kWindow * count) {}

  unsigned count() const { return count_; }

  /// Takes the first free cycle of the bank at or after `tick`; the answer is how long to wait for it. A tick before
  /// the window counts as its start; behind the window nobody is in the way.
  std::uint32_t claim(std::uint64_t tick, std::uint32_t address) {
    const auto end = start_ + kReach;
    const auto bank = address / 4 % count_;
    for (auto at = std::max(tick, start_); at < end; ++at) {
      auto& taken = taken_[at % kWindow * count_ + bank];
      if (taken != 0) continue;
      taken = 1;
      return static_cast<std::uint32_t>(at - tick);
    }
    return tick < end ? static_cast<std::uint32_t>(end - tick) : 0;
  }

  /// For who has its turn at the latest after one other: takes the bank's cycle in `tick`, or when that is taken the
  /// next one in any case. The answer is 0 or 1.
  std::uint32_t claim_soon(std::uint64_t tick, std::uint32_t address) {
    if (tick < start_ || tick + 1 >= start_ + kReach) return 0;
    const auto byte_of = [this, address](std::uint64_t at) -> std::uint8_t& {
      return taken_[at % kWindow * count_ + address / 4 % count_];
    };
    const std::uint32_t wait = byte_of(tick) != 0 ? 1 : 0;
    byte_of(tick + wait) = 1;
    return wait;
  }

  /// The window starts at `tick` from now on; ticks do not go back.
  void move_to(std::uint64_t tick) {
    const auto first = start_ % kWindow;
    const auto gone = std::min(tick - start_, kWindow);
    const auto in_one_piece = std::min(gone, kWindow - first);
    std::fill_n(&taken_[first * count_], in_one_piece * count_, std::uint8_t{0});
    std::fill_n(taken_.begin(), (gone - in_one_piece) * count_, std::uint8_t{0});
    start_ = tick;
  }

  std::uint64_t start() const { return start_; }

  /// For translated code: a byte of each bank for tick % kWindow = 0, then for 1 and so on; not 0 = taken.
  std::uint8_t* taken() { return taken_.data(); }

  void save(state::Writer& writer) const {
    writer.put(start_);
    writer.put(taken_);
  }
  void restore(state::Reader& reader) {
    reader.get(start_);
    std::vector<std::uint8_t> taken;
    reader.get(taken);
    if (taken.size() != taken_.size()) throw Error("a saved state is damaged: it has banks of another memory");
    std::copy(taken.begin(), taken.end(), taken_.begin());
  }

 private:
  unsigned count_;
  std::uint64_t start_ = 0;
  std::vector<std::uint8_t> taken_;  // as many as at construction, always: translated code knows where they are
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
