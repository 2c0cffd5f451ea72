// SPDX-License-Identifier: Apache-2.0
// Takes exceptions and interrupts, and ends a core that cannot continue.
#include "hart/traps.hpp"

#include "hart/csr_numbers.hpp"
#include "mebots/assert.hpp"

#include <algorithm>
#include <bit>

namespace mebots::soc {
namespace {

/// After this number of consecutive exceptions without progress, the core stops.
constexpr std::uint32_t kEndlessRepeats = 16;
/// After this number of consecutive exceptions with the same cause, pc and registers, the core stops. The number is
/// large because a handler may count in memory and leave without mret.
constexpr std::uint32_t kEndlessReturns = 1'000'000;

/// Offsets of GAP8's exception vectors. The vectors of 32 interrupts and of the reset come before them.
constexpr std::uint32_t kIllegalVector = 0x84;
constexpr std::uint32_t kAccessVector = 0x8C;

/// True if the exception is an ecall or ebreak.
bool is_call(std::uint32_t cause) {
  return cause == cause::kMachineEcall || cause == cause::kUserEcall || cause == cause::kBreakpoint;
}

}  // namespace

void Traps::restart() {
  state_ = {};
}

const Instruction* Traps::leave_handler(const Instruction* at) {
  MEBOTS_ASSERT(at->op == Op::mret);
  auto& e = execution_;
  // Execution::cut_pc prevents a new block at a pc to which an interrupt returns. Such a pc may be any instruction, and
  // blocks at all of them would fill the cache. Exceptions return to few pcs.
  const bool from_interrupt = (csrs_.last_trap().cause & cause::kInterrupt) != 0;
  e.pc = csrs_.leave_handler();
  e.cut_pc = from_interrupt ? e.pc : kNoPc;
  e.exit = at + 1;
  e.link = from_interrupt ? nullptr : &at->link;
  e.redirected = true;
  state_.repeats = 0;
  state_.returns = 0;
  return nullptr;
}

Exception Traps::exception_here(std::uint32_t cause, std::uint32_t value) const {
  Exception here{.cause = cause,
                 .pc = execution_.pc,
                 .value = value,
                 .return_address = execution_.x[kReturnAddress],
                 .stack_pointer = execution_.x[kStackPointer]};
  here.instruction = blocks_.word_at(here.pc).value_or(0);
  return here;
}

void Traps::fail(std::uint32_t cause, std::uint32_t value, bool double_trap) {
  state_.fault.last = exception_here(cause, value);
  state_.fault.happened = true;
  state_.fault.double_trap = double_trap;
}

/// Compares the hart's state at this exception with its state at the last exception.
Traps::Progress Traps::progress_since_last(std::uint32_t cause) const {
  const auto& e = execution_;
  const auto& last = state_.last_exception;
  if (state_.repeats == 0) return Progress::some;
  if (last.instructions == e.counters.instructions) return Progress::none;
  // Correct code may execute the same ecall or ebreak repeatedly.
  if (is_call(cause) || last.pc != e.pc || last.cause != cause) return Progress::some;
  // The same exception with a lower stack pointer has occurred in its own handler, which decreases the stack pointer at
  // each entry.
  if (e.x[kStackPointer] < last.registers[kStackPointer]) return Progress::none;
  const auto same = std::equal(last.registers.begin() + 1, last.registers.end(), e.x.begin() + 1);
  if (!same) return Progress::some;
  return last.accesses == e.counters.accesses ? Progress::none : Progress::unknown;
}

bool Traps::take_exception() {
  const auto cause = execution_.trap_cause;
  const auto value = execution_.trap_value;
  MEBOTS_ASSERT((cause & cause::kInterrupt) == 0 && !state_.fault.happened);
  const auto progress = progress_since_last(cause);
  if (state_.repeats == 0) state_.fault.first = exception_here(cause, value);
  state_.repeats = progress == Progress::none ? state_.repeats + 1 : 1;
  state_.returns = progress == Progress::some ? 0 : state_.returns + 1;
  state_.last_exception.pc = execution_.pc;
  state_.last_exception.cause = cause;
  state_.last_exception.instructions = execution_.counters.instructions;
  state_.last_exception.accesses = execution_.counters.accesses;
  if (!is_call(cause)) {
    auto& registers = state_.last_exception.registers;
    std::copy_n(execution_.x.begin(), registers.size(), registers.begin());
    registers[0] = 0;
  }
  if (state_.repeats >= kEndlessRepeats || state_.returns >= kEndlessReturns) {
    fail(cause, value, true);
    return false;
  }
  return enter_handler(cause, value);
}

unsigned Traps::next_interrupt() const {
  // Priorities of interrupts: first the fast interrupts from 31 down to 16, and then external (11), software (3) and
  // timer (7). Source: CV32E40P user manual, chapter "Exceptions and interrupts".
  const auto ready = csrs_.pending();
  MEBOTS_ASSERT(ready != 0 && csrs_.interrupt_ready(), "an interrupt is taken when one is ready");
  if ((ready >> 16) != 0) return 31U - static_cast<unsigned>(std::countl_zero(ready));
  for (const unsigned candidate : {11U, 3U, 7U, 15U, 14U, 13U, 12U, 10U, 9U, 8U, 6U, 5U, 4U, 2U, 1U}) {
    if ((ready >> candidate & 1U) != 0) return candidate;
  }
  return 0;
}

std::uint32_t Traps::handler_of(std::uint32_t cause) const {
  if (cause == cause::kMachineEcall || cause == cause::kUserEcall) return csrs_.call_handler();
  const bool is_interrupt = (cause & cause::kInterrupt) != 0;
  if (csrs_.has_gap8_interrupts()) {
    const auto vectors = csrs_.handlers() & ~0xffU;
    if (is_interrupt) return vectors + 4 * (cause & 31U);
    return vectors + (cause == cause::kIllegalInstruction ? kIllegalVector : kAccessVector);
  }
  const bool is_vectored = (csrs_.handlers() & 1U) != 0 && is_interrupt;
  return (csrs_.handlers() & ~3U) + (is_vectored ? 4 * (cause & 31U) : 0);
}

bool Traps::enter_handler(std::uint32_t cause, std::uint32_t value) {
  MEBOTS_ASSERT(!state_.fault.happened, "a core with a fault runs no more");
  const auto target = handler_of(cause);
  if (!blocks_.word_at(target)) {
    fail(cause, value, false);
    return false;
  }
  csrs_.enter_handler(cause, value);
  execution_.pc = target;
  execution_.link = nullptr;
  execution_.pipeline = {};
  return true;
}

void Traps::visit(state::Visitor& v) {
  if (is_call(state_.last_exception.cause)) state_.last_exception.registers = {};
  v("fault", state_.fault);
  v("last_exception", state_.last_exception);
  v("repeats", state_.repeats);
  v("returns", state_.returns);
}

}  // namespace mebots::soc
