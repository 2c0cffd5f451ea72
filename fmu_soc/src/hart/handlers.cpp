// SPDX-License-Identifier: Apache-2.0
//
// Binds the operations of the standard instruction set, loads and stores apart, to decoded instructions.
#include "hart/bind.hpp"
#include "hart/csr_numbers.hpp"
#include "hart/hart.hpp"
#include "isa/operations.hpp"

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
  e.hart->flush_fetched();
  return next(e, at);
}

const Instruction* end_of_block(Execution& e, const Instruction* at) {
  e.pc = at->pc;
  e.exit = at;
  e.link = &at->link;
  return nullptr;
}

const Instruction* illegal(Execution& e, const Instruction* at) {
  return e.hart->raise(at, cause::kIllegalInstruction, static_cast<std::uint32_t>(at->imm));
}
const Instruction* environment_call(Execution& e, const Instruction* at) {
  return e.hart->raise(at, cause::kMachineEcall, 0);
}
const Instruction* breakpoint(Execution& e, const Instruction* at) {
  return e.hart->raise(at, cause::kBreakpoint, at->pc);
}
const Instruction* csr_access(Execution& e, const Instruction* at) {
  return e.hart->csr_access(at);
}
const Instruction* trap_return(Execution& e, const Instruction* at) {
  return e.hart->trap_return(at);
}
const Instruction* wait_for_interrupt(Execution& e, const Instruction* at) {
  return e.hart->wait_for_interrupt(at);
}

}  // namespace

Operand operand_of(const Instruction& instruction) {
  for (const auto operand : {Operand::immediate, Operand::scalar}) {
    if (instruction.run != handler_of(instruction.op) && instruction.run == handler_of(instruction.op, operand)) {
      return operand;
    }
  }
  return Operand::reg;
}

Handler handler_of(Op op, Operand operand) {
  namespace f = operations;
  if (is_load(op) || is_store(op)) return memory_handler_of(op);
  if (is_simd(op)) return simd_handler_of(op, operand);
  if (const auto xpulp = xpulp_handler_of(op, operand); xpulp != nullptr) return xpulp;
  switch (op) {
    case Op::lui:
    case Op::auipc:
      return constant;
    case Op::jal:
      return jump;
    case Op::jalr:
      return jump_register;
    case Op::beq:
      return branch<f::equal>;
    case Op::bne:
      return branch<f::not_equal>;
    case Op::blt:
      return branch<f::less>;
    case Op::bge:
      return branch<f::greater_equal>;
    case Op::bltu:
      return branch<f::less_unsigned>;
    case Op::bgeu:
      return branch<f::greater_equal_unsigned>;
    case Op::addi:
      return binary<f::add, Operand::immediate>;
    case Op::slti:
      return binary<f::slt, Operand::immediate>;
    case Op::sltiu:
      return binary<f::sltu, Operand::immediate>;
    case Op::xori:
      return binary<f::bit_xor, Operand::immediate>;
    case Op::ori:
      return binary<f::bit_or, Operand::immediate>;
    case Op::andi:
      return binary<f::bit_and, Operand::immediate>;
    case Op::slli:
      return binary<f::sll, Operand::immediate>;
    case Op::srli:
      return binary<f::srl, Operand::immediate>;
    case Op::srai:
      return binary<f::sra, Operand::immediate>;
    case Op::add:
      return binary<f::add>;
    case Op::sub:
      return binary<f::sub>;
    case Op::sll:
      return binary<f::sll>;
    case Op::slt:
      return binary<f::slt>;
    case Op::sltu:
      return binary<f::sltu>;
    case Op::xor_:
      return binary<f::bit_xor>;
    case Op::srl:
      return binary<f::srl>;
    case Op::sra:
      return binary<f::sra>;
    case Op::or_:
      return binary<f::bit_or>;
    case Op::and_:
      return binary<f::bit_and>;
    case Op::fence:
      return nothing;
    case Op::fence_i:
      return fence_instructions;
    case Op::ecall:
      return environment_call;
    case Op::ebreak:
      return breakpoint;
    case Op::mul:
      return binary<f::mul>;
    case Op::mulh:
      return binary<f::mulh>;
    case Op::mulhsu:
      return binary<f::mulhsu>;
    case Op::mulhu:
      return binary<f::mulhu>;
    case Op::div:
      return divide<f::div, divide_extra_signed>;
    case Op::divu:
      return divide<f::divu, divide_extra_unsigned>;
    case Op::rem:
      return divide<f::rem, divide_extra_signed>;
    case Op::remu:
      return divide<f::remu, divide_extra_unsigned>;
    case Op::csrrw:
    case Op::csrrs:
    case Op::csrrc:
    case Op::csrrwi:
    case Op::csrrsi:
    case Op::csrrci:
      return csr_access;
    case Op::mret:
      return trap_return;
    case Op::wfi:
      return wait_for_interrupt;
    case Op::end_of_block:
      return end_of_block;
    default:
      return illegal;
  }
}

}  // namespace mebots::soc
