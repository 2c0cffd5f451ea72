// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/cycle_causes.hpp"
#include "hart/instruction.hpp"
#include "isa/encoding.hpp"

#include <cstdint>
#include <span>

namespace mebots::soc {

class Hart;

/// A load or store of the program.
struct Access {
  std::uint32_t address = 0;
  unsigned size = 0;    // bytes; 0 = the instruction touches no memory
  bool store = false;   // a plain store: Retired::stored is its value
  bool reads = false;   // an atomic operation may do both
  bool writes = false;  // a sc.w that fails does not, but counts as one that does
};

/// A retired instruction.
struct Retired {
  std::uint32_t pc = 0;
  std::uint32_t word = 0;  // a compressed one in the low half
  Decoded decoded;
  Access access;
  std::uint32_t stored = 0;  // by a store, in its low bytes
  CycleShares cycles = {};   // only for an observer without quiet code
};

/// An exception or interrupt that the hart has taken. The hart's pc is the address of the handler. The cycles of the
/// entry are not counted yet.
struct Trapped {
  std::uint32_t pc = 0;  // of the instruction that did not run
  std::uint32_t cause = 0;
  std::uint32_t value = 0;  // mtval
};

/// A range of code for which the observer needs no call after each instruction.
struct QuietCode {
  std::uint32_t begin = 0;
  std::uint32_t size = 0;  // bytes; 0 = no such code

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

  /// Called before the instruction at the hart's pc, which may also trap. If the function returns false, the run ends
  /// before the instruction. If the limit is loose, the run can end only before the first instruction of a block.
  virtual bool before(const Hart& /*hart*/) { return true; }
  virtual void retired(const Hart& /*hart*/, const Retired& /*instruction*/) {}
  /// Returns code in which the observer needs no call per instruction. If an instruction and its successor are both in
  /// this code, the hart does not call retired() and before(). The exceptions are calls, indirect jumps and mret. The
  /// result must be valid until the next call of a function that is not const.
  virtual QuietCode quiet() const { return {}; }
  /// Returns null if the observer needs each instruction. If the result is not null, the observer only needs the steps
  /// that may enter another function. In this case, hot code is translated and records these steps, and before() is not
  /// called. The observer may get the steps late, but before any other event. The result must not change while the
  /// observer is set.
  virtual const FlowMap* flow() const { return nullptr; }
  /// Called with steps that translated code has taken, in their order. During the call, the hart's counters have their
  /// values after the last step.
  virtual void flowed(const Hart& /*hart*/, std::span<const Flow> /*steps*/) {}
  virtual void trapped(const Hart& /*hart*/, const Trapped& /*trap*/) {}
  /// Called when the hart starts to wait for an interrupt, and when it continues.
  virtual void slept(const Hart& /*hart*/) {}
  virtual void woke(const Hart& /*hart*/) {}
  /// Called when the hart is switched off or on. When the hart is switched on, it starts at its pc.
  virtual void switched(const Hart& /*hart*/, bool /*on*/) {}
};

}  // namespace mebots::soc
