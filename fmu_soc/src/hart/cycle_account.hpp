// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/cycle_causes.hpp"
#include "hart/execution.hpp"
#include "hart/observer.hpp"
#include "hart/timing.hpp"

#include <cstdint>

namespace mebots::soc {

/// Divides the cycles of each instruction among their causes, and counts RI5CY's events. Only used for cores that are
/// observed or that count events.
///
/// The cycles from one retired instruction to the next have five parts: waits for cache lines, entries of traps, a
/// cycle for an unaligned target, cycles that are known from decoding (with stalls), and cycles that depend on the
/// execution.
class CycleAccount {
 public:
  CycleAccount(const Execution& execution, const Timing& timing) : execution_(execution), timing_(timing) {}

  /// Measures the next instruction from the present counts of the core. Must be called when the observation begins, and
  /// after a state was restored.
  void restart();
  /// Adds the cycles of a trap's entry. Must be called when a trap is taken.
  void entered_trap() { trap_cycles_ += kTrapEntryCycles; }

  /// Must be called before an instruction runs. `start` is the cycle after the waits for the instruction's cache lines
  /// and before its stall. `decoded` is the number of cycles that is known from decoding, including the stall.
  void begin(std::uint64_t start, std::uint32_t decoded);
  /// Like begin(), for a single instruction whose cache lines have not been fetched yet.
  void begin_alone(std::uint32_t decoded);
  /// Sets the instruction's cycles. Must be called after the instruction has retired and has been counted. `hidden` is
  /// the number of cycles of the following jump that overlap with this instruction.
  void retire(Retired& instruction, std::uint32_t hidden);
  /// Adds the events of the last retired instruction to `events`. If `external` is true, also counts two kinds of
  /// events: waits for banks, and accesses to devices and to all memories other than the core's first memory.
  void count_events(EventCounts& events, const Retired& instruction, bool external) const;

 private:
  struct Mark {
    std::uint64_t cycles = 0;
    std::uint64_t fetch_cycles = 0;
    std::uint64_t far_accesses = 0;
    std::uint64_t device_accesses = 0;
  };
  Mark now() const;
  std::int32_t passed_since(std::uint64_t cycles) const;
  void share_decoded(CycleShares& shares, const Decoded& instruction);
  void share_jump(CycleShares& shares, const Decoded& jump);
  void share_extra(CycleShares& shares, const Retired& instruction, std::int32_t extra) const;

  const Execution& execution_;
  const Timing& timing_;
  Mark last_;                      // counts after the previous instruction
  std::uint32_t trap_cycles_ = 0;  // cycles of trap entries since `last_`
  std::int32_t gap_ = 0;           // cycles from `last_` to the start of the instruction, without waits for cache lines
  std::int32_t decoded_ = 0;
  std::int32_t hidden_ = 0;  // cycles of the next instruction that overlap with the last instruction
  bool is_far_ = false;      // true if the last instruction accessed a memory other than the first one
  bool is_device_ = false;
  bool waited_for_load_ = false;  // true if the last instruction waited for a load
  Previous before_;
};

}  // namespace mebots::soc
