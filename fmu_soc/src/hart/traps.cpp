// SPDX-License-Identifier: Apache-2.0
//
// Exceptions, interrupts, and the end of a core that cannot get past one.
#include "hart/csr_numbers.hpp"
#include "hart/hart.hpp"
#include "hart/observer.hpp"
#include "mebots/assert.hpp"

#include <bit>

namespace mebots::soc {
namespace {

/// An exception that comes back this often at the same place, with no return from a handler between, has no way out.
constexpr std::uint32_t kHopelessRepeats = 16;

constexpr unsigned kReturnAddress = 1;
constexpr unsigned kStackPointer = 2;

/// Vectors of exceptions behind those of 32 interrupts and the reset, with an event unit.
constexpr std::uint32_t kIllegalVector = 0x84;
constexpr std::uint32_t kCallVector = 0x88;
constexpr std::uint32_t kAccessVector = 0x8C;

}  // namespace

const Instruction* Hart::raise(const Instruction* at, std::uint32_t cause, std::uint32_t value) {
  MEBOTS_ASSERT((cause & cause::kInterrupt) == 0);
  auto& e = execution_;
  e.extra_cycles -= stalled_before(at);
  e.pc = at->pc;
  e.exit = at;
  e.link = nullptr;
  e.redirected = true;
  e.leave = Leave::trap;
  e.trap_cause = cause;
  e.trap_value = value;
  return nullptr;
}

const Instruction* Hart::trap_return(const Instruction* at) {
  auto& e = execution_;
  e.pc = csrs_.mepc;
  cut_pc_ = e.pc;
  e.exit = at + 1;
  e.link = nullptr;
  e.redirected = true;
  csrs_.interrupts_on = csrs_.interrupts_were_on;
  csrs_.interrupts_were_on = true;
  exception_repeats_ = 0;
  update_interrupts();
  return nullptr;
}

Exception Hart::exception_here(std::uint32_t cause, std::uint32_t value) const {
  Exception here{.cause = cause,
                 .pc = execution_.pc,
                 .value = value,
                 .return_address = reg(kReturnAddress),
                 .stack_pointer = reg(kStackPointer)};
  std::uint32_t address = 0;
  if (!BlockCache::fetch(memory_, here.pc, here.instruction, address)) here.instruction = 0;
  return here;
}

void Hart::fail(std::uint32_t cause, std::uint32_t value, bool double_trap) {
  fault_.last = exception_here(cause, value);
  fault_.happened = true;
  fault_.double_trap = double_trap;
}

void Hart::take_trap(std::uint32_t cause, std::uint32_t value) {
  const auto pc = execution_.pc;
  // A call of the handler, too, is hopeless when the handler begins with one.
  const bool is_call = cause == cause::kMachineEcall || cause == cause::kBreakpoint;
  const bool again = exception_repeats_ != 0 && exception_pc_ == pc && exception_cause_ == cause &&
                     (!is_call || exception_instructions_ == execution_.counters.instructions);
  if (exception_repeats_ == 0) fault_.first = exception_here(cause, value);
  exception_instructions_ = execution_.counters.instructions;
  exception_repeats_ = again ? exception_repeats_ + 1 : 1;
  exception_pc_ = pc;
  exception_cause_ = cause;
  if (exception_repeats_ >= kHopelessRepeats) {
    fail(cause, value, true);
    return;
  }
  enter_handler(cause, value);
}

void Hart::take_interrupt() {
  // Fast interrupts 31 to 16 come first, the highest number before the others; then external (11), software (3),
  // timer (7). Source: CV32E40P user manual, chapter "Exceptions and interrupts".
  const auto ready = csrs_.mip & csrs_.mie;
  unsigned number = 0;
  MEBOTS_ASSERT(ready != 0 && csrs_.interrupts_on, "an interrupt is taken when one is ready");
  if ((ready >> 16) != 0) {
    number = 31U - static_cast<unsigned>(std::countl_zero(ready));
  } else {
    for (const unsigned candidate : {11U, 3U, 7U, 15U, 14U, 13U, 12U, 10U, 9U, 8U, 6U, 5U, 4U, 2U, 1U, 0U}) {
      if ((ready >> candidate & 1U) != 0) {
        number = candidate;
        break;
      }
    }
  }
  enter_handler(cause::kInterrupt | number, 0);
  if (has_event_unit_) bus_.interrupt_taken(number);
}

std::uint32_t Hart::handler_of(std::uint32_t cause) const {
  const bool is_interrupt = (cause & cause::kInterrupt) != 0;
  if (has_event_unit_) {
    const auto vectors = csrs_.mtvec & ~0xffU;
    if (is_interrupt) return vectors + 4 * (cause & 31U);
    return vectors + (cause == cause::kIllegalInstruction ? kIllegalVector
                      : cause == cause::kMachineEcall     ? kCallVector
                                                          : kAccessVector);
  }
  const bool is_vectored = (csrs_.mtvec & 1U) != 0 && is_interrupt;
  return (csrs_.mtvec & ~3U) + (is_vectored ? 4 * (cause & 31U) : 0);
}

void Hart::set_interrupts(std::uint32_t lines) {
  csrs_.mip = lines;
  update_interrupts();
}

void Hart::enter_handler(std::uint32_t cause, std::uint32_t value) {
  const auto target = handler_of(cause);
  std::uint32_t word = 0;
  std::uint32_t address = 0;
  if (!BlockCache::fetch(memory_, target, word, address)) {
    fail(cause, value, false);
    return;
  }
  csrs_.mepc = execution_.pc;
  csrs_.mcause = cause;
  csrs_.mtval = value;
  csrs_.interrupts_were_on = csrs_.interrupts_on;
  csrs_.interrupts_on = false;
  update_interrupts();
  execution_.pc = target;
  execution_.link = nullptr;
  execution_.pipeline = {};
  if (observer_ != nullptr) observer_->trapped(*this, {csrs_.mepc, cause, value});
  execution_.counters.cycles += kTrapEntryCycles;
}

}  // namespace mebots::soc
