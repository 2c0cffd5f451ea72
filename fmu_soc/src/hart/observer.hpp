// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/cycle_causes.hpp"
#include "hart/instruction.hpp"
#include "isa/encoding.hpp"

#include <cstdint>
#include <span>

namespace mebots::soc {

class Hart;

/// Describes a load or store of the program.
struct Access {
  std::uint32_t address = 0;
  unsigned size = 0;    // bytes; 0 = the instruction accesses no memory
  bool store = false;   // true for a plain store, whose value is in Retired::stored
  bool reads = false;   // true if memory is read; an atomic operation may read and write
  bool writes = false;  // true if memory is written; also set for a sc.w that fails
};

/// Describes an instruction that has retired.
struct Retired {
  std::uint32_t pc = 0;
  std::uint32_t word = 0;  // instruction word; a compressed instruction is in the low half
  Decoded decoded;
  Access access;
  std::uint32_t stored = 0;  // value that a store has written, in the low bytes
  CycleShares cycles = {};   // only valid for an observer that needs each instruction
};

/// Describes an exception or interrupt that the hart has taken. At the call, the hart's pc is the address of the
/// handler, and the cycles of the trap's entry are not counted yet.
struct Trapped {
  std::uint32_t pc = 0;  // address of the instruction that was not executed
  std::uint32_t cause = 0;
  std::uint32_t value = 0;  // value written to mtval
};

/// Describes a range of code in which the observer needs no call after each instruction.
struct QuietCode {
  std::uint32_t begin = 0;
  std::uint32_t size = 0;  // bytes; 0 = the range is empty

  bool holds(std::uint32_t address) const { return address - begin < size; }
};

/// Observes a hart instruction by instruction. The hart calls the observer after each instruction. An observer does not
/// affect the counts of the hart. An observer must outlive the runs that it observes, and must not throw.
class Observer {
 public:
  Observer() = default;
  Observer(const Observer&) = delete;
  Observer& operator=(const Observer&) = delete;
  virtual ~Observer() = default;

  /// Called before the hart executes the instruction at its pc, which may also trap. If the function returns false, the
  /// run ends before the instruction. If the limit is loose, a run can end only before the first instruction of a
  /// block.
  virtual bool before(const Hart& /*hart*/) { return true; }
  virtual void retired(const Hart& /*hart*/, const Retired& /*instruction*/) {}
  /// Returns code in which the observer needs no call per instruction. If an instruction and its successor are both in
  /// this code, the hart does not call retired() and before(). The exceptions are calls, indirect jumps and mret. The
  /// result must be valid until the next call of a function that is not const.
  virtual QuietCode quiet() const { return {}; }
  /// If the observer needs each instruction, returns null. Otherwise the observer only receives the steps that may
  /// enter another function. In this case, hot code is translated and records these steps, and before() is not called.
  /// The hart may report the steps late, but before any other event. The result must not change while the observer is
  /// set.
  virtual const FlowMap* flow() const { return nullptr; }
  /// Called with the steps that translated code has recorded, in their order. During the call, the hart's counters have
  /// their values after the last step.
  virtual void flowed(const Hart& /*hart*/, std::span<const Flow> /*steps*/) {}
  virtual void trapped(const Hart& /*hart*/, const Trapped& /*trap*/) {}
  /// Called when the hart starts to wait for an interrupt, and when the wait ends.
  virtual void slept(const Hart& /*hart*/) {}
  virtual void woke(const Hart& /*hart*/) {}
  /// Called when the hart is switched off or on. After it was switched on, the hart starts at its pc.
  virtual void switched(const Hart& /*hart*/, bool /*on*/) {}
};

}  // namespace mebots::soc
