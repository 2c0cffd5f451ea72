// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/cycle_causes.hpp"
#include "hart/instruction.hpp"
#include "isa/encoding.hpp"

#include <cstdint>
#include <span>

namespace mebots::soc {

class Hart;

struct Access {
  std::uint32_t address = 0;
  unsigned size = 0;    // bytes; 0 = the instruction accesses no memory
  bool store = false;   // true for a plain store, whose value is in Retired::stored
  bool reads = false;   // true if memory is read; an atomic operation may read and write
  bool writes = false;  // true if memory is written; also set for a sc.w that fails
};

struct Retired {
  std::uint32_t pc = 0;
  std::uint32_t word = 0;  // instruction word; a compressed instruction is in the low half
  Decoded decoded;
  Access access;
  std::uint32_t stored = 0;  // value that a store has written, in the low bytes
  CycleShares cycles = {};   // only valid if the observer needs each instruction
};

/// Describes an exception or interrupt that the hart has taken. At the call of Observer::trapped(), the hart's pc is
/// the address of the handler. The cycles of the trap's entry have not been counted yet.
struct Trapped {
  std::uint32_t pc = 0;  // address of the instruction that was not executed
  std::uint32_t cause = 0;
  std::uint32_t value = 0;  // value written to mtval
};

/// A range of code in which the observer need not be called after each instruction.
struct QuietCode {
  std::uint32_t begin = 0;
  std::uint32_t size = 0;  // bytes; 0 = the range is empty

  bool holds(std::uint32_t address) const { return address - begin < size; }
};

/// Observes each instruction of a hart, without effect on the hart's counts. An observer must outlive the runs that it
/// observes. Its functions must not throw.
class Observer {
 public:
  Observer() = default;
  Observer(const Observer&) = delete;
  Observer& operator=(const Observer&) = delete;
  virtual ~Observer() = default;

  /// Called before the hart executes the instruction at its pc. The instruction may also raise an exception. If the
  /// function returns false, the run ends before the instruction. If blocks may run past the limit (loose limit), a run
  /// can only end before the first instruction of a block.
  virtual bool before(const Hart& /*hart*/) { return true; }
  virtual void retired(const Hart& /*hart*/, const Retired& /*instruction*/) {}
  /// Returns code in which the observer need not be called for each instruction. If an instruction and the next
  /// executed one are both in this code, the hart calls neither retired() nor before() between them, except for calls,
  /// indirect jumps and mret. The result must stay valid until the next call of a function that is not const.
  virtual QuietCode quiet() const { return {}; }
  /// Returns null if the observer needs each instruction. Otherwise, the observer only receives the steps from one
  /// instruction to the next that may enter another function: translated code records these steps, and the hart does
  /// not call before(). The hart may report steps late, but before any other event. The result must not change while
  /// the observer is set.
  virtual const FlowMap* flow() const { return nullptr; }
  /// Called with the steps that translated code has recorded, in their order. During the call, the hart's counters
  /// contain their values after the last step.
  virtual void flowed(const Hart& /*hart*/, std::span<const Flow> /*steps*/) {}
  virtual void trapped(const Hart& /*hart*/, const Trapped& /*trap*/) {}
  /// Called when the hart starts to wait for an interrupt, and when the wait ends.
  virtual void slept(const Hart& /*hart*/) {}
  virtual void woke(const Hart& /*hart*/) {}
  /// Called when the hart is switched on or off. A hart that is switched on starts at its pc.
  virtual void switched(const Hart& /*hart*/, bool /*on*/) {}
};

}  // namespace mebots::soc
