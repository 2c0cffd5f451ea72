// SPDX-License-Identifier: Apache-2.0
//
// Exceptions, interrupts, and the end of a core that cannot get past one.
#include "hart/traps.hpp"

#include "hart/csr_numbers.hpp"
#include "mebots/assert.hpp"

#include <bit>

namespace mebots::soc {
namespace {

/// An exception that comes back this often at the same place, with no return from a handler between, never ends. Nor do
/// this many in a row, wherever they are, between which nothing retires: handlers whose first instructions fault.
constexpr std::uint32_t kHopelessRepeats = 16;

constexpr unsigned kReturnAddress = 1;
constexpr unsigned kStackPointer = 2;

/// GAP8's vectors of exceptions, behind those of 32 interrupts and the reset.
constexpr std::uint32_t kIllegalVector = 0x84;
constexpr std::uint32_t kCallVector = 0x88;
constexpr std::uint32_t kAccessVector = 0x8C;

}  // namespace

void Traps::restart() {
  fault_ = {};
  repeats_ = 0;
}

const Instruction* Traps::leave_handler(const Instruction* at) {
  auto& e = execution_;
  e.pc = csrs_.leave_handler();
  e.cut_pc = e.pc;
  e.exit = at + 1;
  e.link = nullptr;
  e.redirected = true;
  repeats_ = 0;
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
  fault_.last = exception_here(cause, value);
  fault_.happened = true;
  fault_.double_trap = double_trap;
}

bool Traps::take_exception() {
  const auto cause = execution_.trap_cause;
  const auto value = execution_.trap_value;
  const auto pc = execution_.pc;
  // A handler may call another one at the same place again and again, as long as something retires between.
  const bool is_call = cause == cause::kMachineEcall || cause == cause::kBreakpoint;
  const bool nothing_retired = instructions_ == execution_.counters.instructions;
  const bool again = repeats_ != 0 && (nothing_retired || (pc_ == pc && cause_ == cause && !is_call));
  if (repeats_ == 0) fault_.first = exception_here(cause, value);
  instructions_ = execution_.counters.instructions;
  repeats_ = again ? repeats_ + 1 : 1;
  pc_ = pc;
  cause_ = cause;
  if (repeats_ >= kHopelessRepeats) {
    fail(cause, value, true);
    return false;
  }
  return enter_handler(cause, value);
}

unsigned Traps::next_interrupt() const {
  // Fast interrupts 31 to 16 come first, the highest number before the others; then external (11), software (3),
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
  const bool is_interrupt = (cause & cause::kInterrupt) != 0;
  if (csrs_.has_gap8_interrupts()) {
    const auto vectors = csrs_.mtvec() & ~0xffU;
    if (is_interrupt) return vectors + 4 * (cause & 31U);
    return vectors + (cause == cause::kIllegalInstruction ? kIllegalVector
                      : cause == cause::kMachineEcall     ? kCallVector
                                                          : kAccessVector);
  }
  const bool is_vectored = (csrs_.mtvec() & 1U) != 0 && is_interrupt;
  return (csrs_.mtvec() & ~3U) + (is_vectored ? 4 * (cause & 31U) : 0);
}

bool Traps::enter_handler(std::uint32_t cause, std::uint32_t value) {
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
  v("fault", fault_);
  v("pc", pc_);
  v("cause", cause_);
  v("repeats", repeats_);
  v("instructions", instructions_);
}

}  // namespace mebots::soc
