// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/instruction.hpp"
#include "isa/encoding.hpp"

#include <cstdint>
#include <span>

namespace mebots::soc {

class Hart;

/// A load or store of the program.
struct Access {
  std::uint32_t address = 0;
  unsigned size = 0;  // bytes; 0 = the instruction touches no memory
  bool store = false;
};

/// A retired instruction.
struct Retired {
  std::uint32_t pc = 0;
  std::uint32_t word = 0;  // a compressed one in the low half
  Decoded decoded;
  Access access;
  std::uint32_t stored = 0;  // by a store, in its low bytes
};

/// A taken trap or interrupt. The hart's pc is at the handler; the cycles to enter it follow.
struct Trapped {
  std::uint32_t pc = 0;  // of the instruction that did not run
  std::uint32_t cause = 0;
  std::uint32_t value = 0;  // mtval
};

/// Code in which an observer needs no call per instruction.
struct QuietCode {
  std::uint32_t begin = 0;
  std::uint32_t size = 0;  // bytes; 0 = no such code

  bool holds(std::uint32_t address) const { return address - begin < size; }
};

/// Observes a hart instruction by instruction. The hart calls it after each instruction; the counts are the same as
/// without an observer. An observer must outlive the runs that it observes, and must not throw.
class Observer {
 public:
  Observer() = default;
  Observer(const Observer&) = delete;
  Observer& operator=(const Observer&) = delete;
  virtual ~Observer() = default;

  /// The instruction at the hart's pc comes next, or a trap if it cannot run. False: the run ends before it; with a
  /// loose limit, before the next block for whose first instruction the answer is false.
  virtual bool before(const Hart& /*hart*/) { return true; }
  virtual void retired(const Hart& /*hart*/, const Retired& /*instruction*/) {}
  /// Instructions that begin here and go on here need not be told, nor asked about, but for calls, jumps by a register
  /// and returns from traps. The answer holds until the next call of a function that is not const.
  virtual QuietCode quiet() const { return {}; }
  /// Not null: it only wants to hear where control may go to another function, and may hear of it late, but before
  /// anything else happens. Hot code is translated then, and notes these steps; before() is not asked. The answer must
  /// not change while it watches.
  virtual const FlowMap* flow() const { return nullptr; }
  /// Steps that translated code has taken, in their order. The hart's counters are those behind the last one.
  virtual void flowed(const Hart& /*hart*/, std::span<const Flow> /*steps*/) {}
  virtual void trapped(const Hart& /*hart*/, const Trapped& /*trap*/) {}
  /// The hart waits for an interrupt from now on, or goes on after one.
  virtual void slept(const Hart& /*hart*/) {}
  virtual void woke(const Hart& /*hart*/) {}
  /// The hart was switched off, or on: then it begins anew at its pc.
  virtual void switched(const Hart& /*hart*/, bool /*on*/) {}
};

}  // namespace mebots::soc
