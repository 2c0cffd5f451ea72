// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/cycle_causes.hpp"
#include "hart/execution.hpp"
#include "hart/observer.hpp"
#include "hart/timing.hpp"

#include <cstdint>

namespace mebots::soc {

/// Divides the cycles of a core among their causes, instruction by instruction, and counts RI5CY's events. Only cores
/// that are observed or count events use it.
///
/// The cycles from one retired instruction to the next are: waits for cache lines, entries of traps, a cycle for an
/// unaligned target, the cycles that follow from decoding (with stalls), and those that execution added.
class CycleAccount {
 public:
  CycleAccount(const Execution& execution, const Timing& timing) : execution_(execution), timing_(timing) {}

  /// Starts at the core's present counts.
  void restart();
  /// A trap was taken; the cycles of its entry follow.
  void entered_trap() { trap_cycles_ += kTrapEntryCycles; }

  /// Called before an instruction runs. `start`: the cycle in which it starts, before its stall; it includes waits for
  /// its lines. `decoded`: its cycles as far as decoding determines them, with its stall.
  void begin(std::uint64_t start, std::uint32_t decoded);
  /// The same for an instruction that runs alone, whose lines have not been fetched yet.
  void begin_alone(std::uint32_t decoded);
  /// Called after the instruction has retired and was counted. `hidden`: cycles of the following jump that are
  /// subtracted from this instruction. Sets the instruction's cycles.
  void retire(Retired& instruction, std::uint32_t hidden);
  /// Adds the events of the instruction that retired last. `external`: the core counts accesses outside its first
  /// memory.
  void count_events(EventCounts& events, const Retired& instruction, bool external) const;

 private:
  /// Counts at one moment.
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
  Mark last_;                      // after the instruction before
  std::uint32_t trap_cycles_ = 0;  // of entries since then
  std::int32_t gap_ = 0;           // cycles from there to the instruction's start
  std::int32_t decoded_ = 0;
  std::int32_t hidden_ = 0;  // cycles of the next instruction that the last one has subtracted
  bool is_far_ = false;      // the access of the last instruction
  bool is_device_ = false;
  bool waited_for_load_ = false;  // the last instruction
  Previous before_;               // the instruction before
};

}  // namespace mebots::soc
