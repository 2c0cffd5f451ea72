// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/assert.hpp"
#include "mebots/error.hpp"
#include "mebots/state/visitor.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace mebots::soc {

/// Stores which cycles of the banks of a shared memory are claimed, in a table with a row for each tick and a byte for
/// each bank. A bank serves one word per cycle. Consecutive words are in consecutive banks.
///
/// Translated code increases pointers into the table without checks. Therefore the table has spare rows after the last
/// tick that a core can reach, and only the scheduler moves rows, between runs.
class Banks {
 public:
  static constexpr unsigned kMost = 32;
  /// Number of ticks after which the scheduler must move the rows that are still used to the front of the table: see
  /// must_start_over().
  static constexpr std::uint64_t kTurn = 4096;
  /// kLongestRun is the maximum number of ticks of one run of translated code. The last block of the run can exceed it
  /// by at most kLongestBlock ticks.
  static constexpr std::uint64_t kLongestRun = 1024;
  static constexpr std::uint64_t kLongestBlock = 5120;
  /// Number of ticks, from the start of the table, in which banks can be claimed. A core may reach the last of these
  /// ticks and wait there.
  static constexpr std::uint64_t kReach = kLongestRun + kLongestBlock + 1024;

  /// `count` must be a power of two, at most kMost.
  explicit Banks(unsigned count = 16) : count_(count), taken_(kRows * count), unread_(kReach * count) { set_horizon(); }
  Banks(const Banks&) = delete;
  Banks& operator=(const Banks&) = delete;

  unsigned count() const { return count_; }

  /// Returns the number of ticks from `tick` to the first free cycle of the bank. If `tick` is before the start of the
  /// table, searches from the start. All cycles from kReach ticks after the start are free.
  std::uint32_t wait(std::uint64_t tick, std::uint32_t address) const {
    const auto end = start_ + kReach;
    if (tick >= end) return 0;
    auto at = std::max(tick, start_);
    while (at < end && taken_[place_of(at, address)] != 0) ++at;
    return static_cast<std::uint32_t>(at - tick);
  }
  /// Claims the bank in the first tick in which it is free: see wait(). Returns the number of ticks from `tick` to this
  /// tick.
  std::uint32_t claim(std::uint64_t tick, std::uint32_t address) {
    const auto waited = wait(tick, address);
    if (tick + waited < start_ + kReach) byte_of(tick + waited, address) = 1;
    return waited;
  }
  /// Returns the number of ticks from `tick` to the end of the table. All banks are free after the end.
  std::uint64_t ticks_left(std::uint64_t tick) const { return start_ + kReach - std::min(tick, start_ + kReach); }

  /// Claims, for a beat of the DMA in `tick`, the banks of all words from `address` up to, but not including, `end`. If
  /// a bank is already claimed in this tick, claims it in the next tick without a check, because L1 serves the DMA and
  /// the cores in turn. Returns 1 if any bank was already claimed, otherwise 0. If `tick` or the next tick is outside
  /// the table, has no effect and returns 0.
  std::uint32_t claim_or_next(std::uint64_t tick, std::uint32_t address, std::uint32_t end) {
    if (tick < start_ || tick + 1 >= start_ + kReach) return 0;
    auto* row = &byte_of(tick, 0);
    std::uint32_t wait = 0;
    for (; address < end; address += 4) {
      const auto bank = address / 4 & (count_ - 1);
      const std::uint32_t taken = row[bank];  // 0 or 1; avoids a branch that the host cannot predict
      row[bank + taken * count_] = 1;
      wait |= taken;
    }
    return wait;
  }

  /// Removes the rows before `tick`. `tick` must not decrease from call to call.
  void move_to(std::uint64_t tick) {
    MEBOTS_ASSERT(tick >= start_, "ticks do not go back");
    clear(start_, tick);
    start_ = tick;
    set_horizon();
  }
  std::uint64_t start() const { return start_; }
  void free_all() { std::fill(taken_.begin(), taken_.end(), std::uint8_t{0}); }

  /// Returns true if start_over() must be called to move to `tick`.
  bool must_start_over(std::uint64_t tick) const { return tick >= base_ + kTurn; }
  /// Removes the rows before `tick`, and moves the others to the front of the table. There must be no claims after tick
  /// `last`. Returns the number of bytes by which the rows were moved.
  std::uint64_t start_over(std::uint64_t tick, std::uint64_t last) {
    move_to(tick);
    const auto first = std::min(tick - base_, kRows);
    const auto rows = last < tick ? 0 : std::min(last + 1 - tick, kRows - first);
    std::copy_n(taken_.data() + first * count_, rows * count_, taken_.begin());
    clear(base_ + std::max(first, rows), base_ + first + rows);
    const auto moved = (tick - base_) * count_;
    base_ = tick;
    MEBOTS_ASSERT(start_ == base_);
    set_horizon();
    return moved;
  }

  /// Returns the address of the first bank's byte in a tick, for translated code. The row of the next tick is count()
  /// bytes later.
  std::uint8_t* row(std::uint64_t tick) { return &byte_of(std::max(tick, start_), 0); }
  /// Returns the address of a pointer to the end of the rows in which a bank can be claimed.
  const std::uint8_t* const* horizon() const { return &horizon_; }
  /// Returns a table to which translated code writes if the memory has a single user. The content is not used.
  std::uint8_t* unread() { return unread_.data(); }

  void visit(state::Visitor& v) {
    std::vector<std::uint8_t> taken;
    if (!v.restores()) taken = taken_from_start();
    v("start", start_);
    v("taken", taken);
    if (!v.restores()) return;
    if (taken.size() > taken_.size())
      throw Error(ErrorCode::state_damaged, "a saved state is damaged: it has banks of another memory");
    base_ = start_;
    set_horizon();
    std::fill(std::copy(taken.begin(), taken.end(), taken_.begin()), taken_.end(), std::uint8_t{0});
  }

 private:
  static constexpr std::uint64_t kRows = kTurn + kReach + kLongestBlock;

  /// Returns the claims from the start of the table to the last claim. The result is short, because most of the table
  /// is free.
  std::vector<std::uint8_t> taken_from_start() const {
    const auto begin = std::min<std::uint64_t>((start_ - base_) * count_, taken_.size());
    MEBOTS_ASSERT(start_ >= base_, "the table begins before what it shows");
    std::uint64_t end = taken_.size();
    for (std::uint64_t eight = 0; end >= begin + sizeof eight; end -= sizeof eight) {
      std::memcpy(&eight, &taken_[end - sizeof eight], sizeof eight);
      if (eight != 0) break;
    }
    while (end > begin && taken_[end - 1] == 0) --end;
    return {taken_.data() + begin, taken_.data() + end};
  }
  std::size_t place_of(std::uint64_t tick, std::uint32_t address) const {
    return (tick - base_) * count_ + (address / 4 & (count_ - 1));
  }
  std::uint8_t& byte_of(std::uint64_t tick, std::uint32_t address) { return taken_[place_of(tick, address)]; }
  void clear(std::uint64_t from, std::uint64_t to) {
    MEBOTS_ASSERT(from >= base_);
    const auto first = std::min(from - base_, kRows);
    const auto last = std::min(to - base_, kRows);
    std::fill(taken_.begin() + static_cast<std::ptrdiff_t>(first * count_),
              taken_.begin() + static_cast<std::ptrdiff_t>(last * count_), std::uint8_t{0});
  }

  void set_horizon() { horizon_ = taken_.data() + std::min(start_ - base_ + kReach, kRows) * count_; }

  unsigned count_;
  std::uint64_t base_ = 0;   // tick of the table's first row
  std::uint64_t start_ = 0;  // rows of earlier ticks were cleared
  std::vector<std::uint8_t> taken_;
  std::vector<std::uint8_t> unread_;
  const std::uint8_t* horizon_ = nullptr;
};

/// Connects a core to the banks. Converts active cycles of the core to ticks.
class BankSchedule {
 public:
  explicit BankSchedule(Banks& banks) : banks_(&banks) {}

  /// Sets the number of ticks for which an access occupies its bank, at least 1.
  void set_ticks(std::uint32_t ticks) { ticks_ = ticks; }

  /// Active cycle `cycle` of the core is tick `cycle + offset` of the banks (modulo 2^64).
  void set_offset(std::uint64_t offset) { offset_ = offset; }

  /// Returns how many cycles an access must wait for its bank. `cycle` is the number of active cycles of the core
  /// before the access.
  std::uint32_t wait(std::uint64_t cycle, std::uint32_t address) const {
    return banks_->wait(cycle + offset_, address);
  }
  /// Returns the number of cycles from active cycle `cycle` to the end of the bank table. All banks are free after the
  /// end.
  std::uint64_t cycles_left(std::uint64_t cycle) const { return banks_->ticks_left(cycle + offset_); }

  /// Claims a bank for an access in active cycle `cycle`. Returns the number of cycles that the access waits.
  std::uint32_t claim(std::uint64_t cycle, std::uint32_t address) {
    const auto wait = banks_->claim(cycle + offset_, address);
    for (std::uint32_t i = 1; i < ticks_; ++i) banks_->claim(cycle + offset_ + wait + i, address);
    return wait;
  }

 private:
  Banks* banks_;
  std::uint32_t ticks_ = 1;
  std::uint64_t offset_ = 0;
};

}  // namespace mebots::soc
