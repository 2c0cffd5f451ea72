// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/bytes.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace mebots::soc {

/// Which cycles of the banks of a shared memory are taken: a table with a row per tick and a byte per bank, from some
/// tick on. A bank serves one word per cycle; consecutive words lie in consecutive banks.
///
/// Translated code holds on to places in the table, and goes on in it without a look: so it has room behind the last
/// tick that can be waited for, and only whoever has the whole picture lets it start over.
class Banks {
 public:
  static constexpr unsigned kMost = 32;
  /// The table wants to start over when time has come to this row.
  static constexpr std::uint64_t kTurn = 4096;
  /// Most ticks of one run of translated code, and most that it can go beyond them in the block in which they end.
  static constexpr std::uint64_t kLongestRun = 1024;
  static constexpr std::uint64_t kLongestBlock = 5120;

  /// `count` must be a power of two, at most kMost.
  explicit Banks(unsigned count = 16)
      : count_(count), taken_(kRows * count), unread_((kLongestRun + kLongestBlock) * count) {}

  unsigned count() const { return count_; }

  /// Takes the first free cycle of the bank at or after `tick`; the answer is how long to wait for it. A tick before
  /// the start counts as the start; behind the horizon nobody is in the way.
  std::uint32_t claim(std::uint64_t tick, std::uint32_t address) {
    const auto end = base_ + kHorizon;
    for (auto at = std::max(tick, start_); at < end; ++at) {
      auto& taken = byte_of(at, address);
      if (taken != 0) continue;
      taken = 1;
      return static_cast<std::uint32_t>(at - tick);
    }
    return tick < end ? static_cast<std::uint32_t>(end - tick) : 0;
  }

  /// For who has its turn at the latest after one other: takes the bank's cycle in `tick`, or when that is taken the
  /// next one in any case. The answer is 0 or 1.
  std::uint32_t claim_soon(std::uint64_t tick, std::uint32_t address) {
    if (tick < start_ || tick + 1 >= base_ + kHorizon) return 0;
    const std::uint32_t wait = byte_of(tick, address) != 0 ? 1 : 0;
    byte_of(tick + wait, address) = 1;
    return wait;
  }

  /// Nobody asks for ticks before `tick` any more; ticks do not go back.
  void move_to(std::uint64_t tick) {
    clear(start_, tick);
    start_ = tick;
  }
  std::uint64_t start() const { return start_; }

  /// Whether the table must start over before it can move to `tick`.
  bool must_start_over(std::uint64_t tick) const { return tick >= base_ + kTurn; }
  /// The table begins at `tick` from now on, which it moves to. Nothing is taken behind `last`.
  void start_over(std::uint64_t tick, std::uint64_t last) {
    move_to(tick);
    const auto first = std::min(tick - base_, kRows);
    const auto rows = last < tick ? 0 : std::min(last + 1 - tick, kRows - first);
    std::copy_n(&taken_[first * count_], rows * count_, taken_.begin());  // kTurn rows lie between, or none
    clear(base_ + std::max(first, rows), base_ + first + rows);
    base_ = tick;
  }

  /// For translated code: the byte of the first bank in a tick. The next tick's are count() on.
  std::uint8_t* row(std::uint64_t tick) { return &byte_of(std::max(tick, start_), 0); }
  /// The row behind the last one that can be waited for.
  const std::uint8_t* horizon() const { return &taken_[kHorizon * count_]; }
  /// A table to write to for who is alone. It is not cleared, so what stands in it means nothing.
  std::uint8_t* unread() { return unread_.data(); }

  void save(state::Writer& writer) const {
    const auto last = std::find_if(taken_.rbegin(), taken_.rend(), [](auto taken) { return taken != 0; });
    const auto begin = std::min<std::uint64_t>((start_ - base_) * count_, taken_.size());
    const auto end = std::max<std::uint64_t>(begin, static_cast<std::uint64_t>(taken_.rend() - last));
    writer.put(start_);
    writer.put(std::span(taken_).subspan(begin, end - begin));
  }
  void restore(state::Reader& reader) {
    std::vector<std::uint8_t> taken;
    reader.get(start_);
    reader.get(taken);
    if (taken.size() > kHorizon * count_) throw Error("a saved state is damaged: it has banks of another memory");
    base_ = start_;
    std::fill(std::copy(taken.begin(), taken.end(), taken_.begin()), taken_.end(), std::uint8_t{0});
  }

 private:
  /// What waits beyond a run may wait this long.
  static constexpr std::uint64_t kHorizon = kTurn + kLongestRun + kLongestBlock + 1024;
  static constexpr std::uint64_t kRows = kHorizon + kLongestBlock;

  std::uint8_t& byte_of(std::uint64_t tick, std::uint32_t address) {
    return taken_[(tick - base_) * count_ + address / 4 % count_];
  }
  void clear(std::uint64_t from, std::uint64_t to) {
    const auto first = std::min(from - base_, kRows);
    const auto last = std::min(to - base_, kRows);
    std::fill(taken_.begin() + static_cast<std::ptrdiff_t>(first * count_),
              taken_.begin() + static_cast<std::ptrdiff_t>(last * count_), std::uint8_t{0});
  }

  unsigned count_;
  std::uint64_t base_ = 0;   // tick of the first row
  std::uint64_t start_ = 0;  // what came before is cleared
  std::vector<std::uint8_t> taken_;
  std::vector<std::uint8_t> unread_;
};

/// Banks as one core sees them: it counts its own active cycles.
class BankSchedule {
 public:
  explicit BankSchedule(Banks& banks) : banks_(&banks) {}

  /// Active cycle `cycle` of the core is tick `cycle + offset` of the banks (modulo 2^64).
  void set_offset(std::uint64_t offset) { offset_ = offset; }

  /// Extra cycles of an access in active cycle `cycle`.
  std::uint32_t claim(std::uint64_t cycle, std::uint32_t address) { return banks_->claim(cycle + offset_, address); }

  std::uint64_t tick_of(std::uint64_t cycle) const { return cycle + offset_; }
  Banks& banks() { return *banks_; }

 private:
  Banks* banks_;
  std::uint64_t offset_ = 0;
};

}  // namespace mebots::soc
