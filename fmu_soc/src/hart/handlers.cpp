// SPDX-License-Identifier: Apache-2.0
//
// What every instruction does: the column of meanings of isa/instructions.inc, and the handlers of the standard
// instruction set but for loads and stores.
#include "hart/bind.hpp"
#include "hart/csr_numbers.hpp"
#include "hart/csrs.hpp"
#include "hart/fetch.hpp"
#include "hart/meaning_simd.hpp"
#include "hart/meaning_xpulp.hpp"
#include "hart/rooms.hpp"
#include "hart/traps.hpp"
#include "isa/operations.hpp"

#include <array>
#include <cstddef>

namespace mebots::soc {
namespace {

/// lui, auipc
const Instruction* constant(Execution& e, const Instruction* at) {
  e.x[at->rd] = static_cast<std::uint32_t>(at->imm);
  return next(e, at);
}

template <auto Compute, auto ExtraCycles>
const Instruction* divide(Execution& e, const Instruction* at) {
  const auto divisor = e.x[at->rs2];
  e.extra_cycles += ExtraCycles(divisor);
  e.x[at->rd] = Compute(e.x[at->rs1], divisor);
  return next(e, at);
}

template <auto Holds>
const Instruction* branch(Execution& e, const Instruction* at) {
  return Holds(e.x[at->rs1], e.x[at->rs2]) ? take_branch(e, at) : next(e, at);
}

const Instruction* jump(Execution& e, const Instruction* at) {
  e.x[at->rd] = at[1].pc;
  e.pc = static_cast<std::uint32_t>(at->imm);
  e.jumped = at->rs2 == 0;
  e.redirected = true;
  e.exit = at + 1;
  e.link = &at->link;
  return nullptr;
}

const Instruction* jump_register(Execution& e, const Instruction* at) {
  const auto target = (e.x[at->rs1] + static_cast<std::uint32_t>(at->imm)) & ~1U;
  e.x[at->rd] = at[1].pc;
  e.pc = target;
  e.jumped = at->rs2 == 0;
  e.redirected = true;
  e.exit = at + 1;
  e.link = &at->link;  // where it went last
  return nullptr;
}

/// fence: stores are seen at once, also by the decoder.
const Instruction* nothing(Execution& e, const Instruction* at) {
  return next(e, at);
}

const Instruction* fence_instructions(Execution& e, const Instruction* at) {
  e.rooms->fetch.flush();
  return next(e, at);
}

const Instruction* end_of_block(Execution& e, const Instruction* at) {
  e.pc = at->pc;
  e.exit = at;
  e.link = &at->link;
  return nullptr;
}

const Instruction* illegal(Execution& e, const Instruction* at) {
  return e.raise(at, cause::kIllegalInstruction, static_cast<std::uint32_t>(at->imm));
}
const Instruction* environment_call(Execution& e, const Instruction* at) {
  return e.raise(at, cause::kMachineEcall, 0);
}
const Instruction* breakpoint(Execution& e, const Instruction* at) {
  return e.raise(at, cause::kBreakpoint, at->pc);
}
const Instruction* csr_access(Execution& e, const Instruction* at) {
  return e.rooms->csrs.access(at);
}
const Instruction* trap_return(Execution& e, const Instruction* at) {
  return e.rooms->traps.leave_handler(at);
}
const Instruction* wait_for_interrupt(Execution& e, const Instruction* at) {
  return e.leave_after(at, Leave::sleep);
}

}  // namespace

namespace meaning {

template <Op kOp>
Handler access(Operand) {
  return memory_handler_of(kOp);
}

/// Of each operation: its handler, by where the second operand comes from.
using Meaning = Handler (*)(Operand);
constexpr auto kMeanings = std::to_array<Meaning>({
#define MEBOTS_OP(name, traits, meaning, ...) meaning,
#include "isa/instructions.inc"
});

}  // namespace meaning

Operand operand_of(const Instruction& instruction) {
  for (const auto operand : {Operand::immediate, Operand::scalar}) {
    if (instruction.run != handler_of(instruction.op) && instruction.run == handler_of(instruction.op, operand)) {
      return operand;
    }
  }
  return Operand::reg;
}

Handler handler_of(Op op, Operand operand) {
  return meaning::kMeanings[static_cast<std::size_t>(op)](operand);
}

}  // namespace mebots::soc
