// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/block_cache.hpp"
#include "hart/csrs.hpp"
#include "hart/execution.hpp"
#include "mebots/state/visitor.hpp"

#include <array>
#include <cstdint>

namespace mebots::soc {

/// An exception, and what the core was at.
struct Exception {
  std::uint32_t cause = 0;
  std::uint32_t pc = 0;
  std::uint32_t value = 0;        // mtval
  std::uint32_t instruction = 0;  // the word at pc, 0 when it cannot be fetched
  std::uint32_t return_address = 0;
  std::uint32_t stack_pointer = 0;

  void visit(state::Visitor& v) {
    v("cause", cause);
    v("pc", pc);
    v("value", value);
    v("instruction", instruction);
    v("return_address", return_address);
    v("stack_pointer", stack_pointer);
  }
};

/// The end of a core: a trap without handler, or one that the handler itself cannot get past.
struct Fault {
  bool happened = false;
  bool double_trap = false;
  Exception last;
  Exception first;  // that it began with: the first one since a return from a handler

  void visit(state::Visitor& v) {
    v("happened", happened);
    v("double_trap", double_trap);
    v("last", last);
    v("first", first);
  }
};

/// Takes a core into its handlers and out of them, and knows when that never ends.
class Traps {
 public:
  Traps(Execution& execution, Csrs& csrs, const BlockCache& blocks)
      : execution_(execution), csrs_(csrs), blocks_(blocks) {}

  void restart();
  /// The exception with which the last block was left; the cycles to its handler are not counted yet. False: the core
  /// cannot go on (`fault`).
  bool take_exception();
  /// The first of the interrupts that are ready.
  unsigned next_interrupt() const;
  /// Goes to the handler of an exception or interrupt. False: its first instruction cannot be fetched, which is the
  /// end.
  bool enter_handler(std::uint32_t cause, std::uint32_t value);
  /// mret
  const Instruction* leave_handler(const Instruction* at);

  const Fault& fault() const { return fault_; }
  /// Whether no handler has returned since the last exception: fault().first is the first one since.
  bool in_exception() const { return repeats_ != 0; }

  void visit(state::Visitor& v);

 private:
  enum class Progress : std::uint8_t {
    none,     // the hart is where it was, or nests handlers
    unknown,  // the registers are the same, but memory may have changed
    some,
  };

  /// A handler may leave without mret, as one that calls longjmp. So the next exception at the same place is compared
  /// with this one.
  struct LastException {
    std::uint32_t pc = 0;
    std::uint32_t cause = 0;
    std::uint64_t instructions = 0;  // retired before it
    std::uint64_t accesses = 0;
    std::array<std::uint32_t, 32> registers{};

    void visit(state::Visitor& v) {
      v("pc", pc);
      v("cause", cause);
      v("instructions", instructions);
      v("accesses", accesses);
      v("registers", registers);
    }
  };

  Progress progress_since_last(std::uint32_t cause) const;
  Exception exception_here(std::uint32_t cause, std::uint32_t value) const;
  void fail(std::uint32_t cause, std::uint32_t value, bool double_trap);
  std::uint32_t handler_of(std::uint32_t cause) const;

  Execution& execution_;
  Csrs& csrs_;
  const BlockCache& blocks_;
  Fault fault_;
  LastException last_exception_;
  std::uint32_t repeats_ = 0;  // exceptions in a row without progress; 0: none since a handler returned
  std::uint32_t returns_ = 0;  // exceptions in a row that leave the registers as they were
};

}  // namespace mebots::soc
