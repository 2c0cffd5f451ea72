// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/block_cache.hpp"
#include "hart/csrs.hpp"
#include "hart/execution.hpp"
#include "mebots/state/visitor.hpp"

#include <array>
#include <cstdint>

namespace mebots::soc {

struct Exception {
  std::uint32_t cause = 0;
  std::uint32_t pc = 0;
  std::uint32_t value = 0;        // value written to mtval
  std::uint32_t instruction = 0;  // word at `pc`; 0 if it cannot be fetched
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

/// The reason why a core stopped permanently: a trap without a handler, or an endless repetition of traps in a handler.
struct Fault {
  bool happened = false;
  bool double_trap = false;
  Exception last;
  Exception first;  // first exception since a handler last returned

  void visit(state::Visitor& v) {
    v("happened", happened);
    v("double_trap", double_trap);
    v("last", last);
    v("first", first);
  }
};

/// Stores the state at the last exception, which is compared with the state at the next exception at the same pc. The
/// comparison also detects endless exceptions whose handlers leave without mret, for example by longjmp. For an ecall
/// or ebreak, `registers` has no meaning, and is 0 in a saved state.
struct LastException {
  std::uint32_t pc = 0;
  std::uint32_t cause = 0;
  std::uint64_t instructions = 0;  // number of instructions that had retired
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

/// State of a core's trap handling. Translated code changes it at an ecall and at mret.
struct TrapState {
  Fault fault;
  LastException last_exception;
  std::uint32_t repeats = 0;  // consecutive exceptions without progress; 0 = no exception since a handler returned
  std::uint32_t returns = 0;  // consecutive exceptions with unchanged registers
};

/// Enters and leaves a core's trap handlers, and detects endless traps.
class Traps {
 public:
  static constexpr unsigned kReturnAddress = 1;  // numbers of registers
  static constexpr unsigned kStackPointer = 2;

  Traps(Execution& execution, Csrs& csrs, const BlockCache& blocks)
      : execution_(execution), csrs_(csrs), blocks_(blocks) {
    execution.host.traps = &state_;
  }

  void restart();
  /// Takes the exception that ended the last block. Does not count the cycles of the handler's entry. If the core
  /// cannot continue, sets fault() and returns false.
  bool take_exception();
  /// Returns the number of the pending interrupt with the highest priority.
  unsigned next_interrupt() const;
  /// Enters the handler of an exception or interrupt. If the handler's first instruction cannot be fetched, sets
  /// fault() and returns false.
  bool enter_handler(std::uint32_t cause, std::uint32_t value);
  /// Executes mret.
  const Instruction* leave_handler(const Instruction* at);

  const Fault& fault() const { return state_.fault; }
  /// True if the core took an exception, and no handler has returned since that exception. fault().first is the first
  /// exception since the last return of a handler.
  bool in_exception() const { return state_.repeats != 0; }

  void visit(state::Visitor& v);

 private:
  enum class Progress : std::uint8_t {
    none,     // registers are unchanged, or handlers are nested
    unknown,  // registers are unchanged, but memory may have changed
    some,
  };

  Progress progress_since_last(std::uint32_t cause) const;
  Exception exception_here(std::uint32_t cause, std::uint32_t value) const;
  void fail(std::uint32_t cause, std::uint32_t value, bool double_trap);
  std::uint32_t handler_of(std::uint32_t cause) const;

  Execution& execution_;
  Csrs& csrs_;
  const BlockCache& blocks_;
  TrapState state_;
};

}  // namespace mebots::soc
