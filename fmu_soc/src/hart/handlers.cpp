// SPDX-License-Identifier: Apache-2.0
//
// Binds the operations of the standard instruction set to decoded instructions.
#include "hart/csr_numbers.hpp"
#include "hart/handler.hpp"
#include "hart/hart.hpp"
#include "hart/ram_access.hpp"
#include "isa/operations.hpp"

#include <cstring>
#include <type_traits>

namespace mebots::soc {
namespace {

template <auto Compute>
const Instruction* with_register(Execution& e, const Instruction* at) {
  e.x[at->rd] = Compute(e.x[at->rs1], e.x[at->rs2]);
  return next(e, at);
}

template <auto Compute>
const Instruction* with_immediate(Execution& e, const Instruction* at) {
  e.x[at->rd] = Compute(e.x[at->rs1], static_cast<std::uint32_t>(at->imm));
  return next(e, at);
}

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
  if (Holds(e.x[at->rs1], e.x[at->rs2])) {
    e.pc = static_cast<std::uint32_t>(at->imm);
    e.extra_cycles += kTakenBranchExtra;
    e.jumped = true;
    e.redirected = true;
    e.exit = at + 1;
    e.link = &at->link;
    return nullptr;
  }
  return next(e, at);
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

template <typename T>
const Instruction* load(Execution& e, const Instruction* at) {
  const auto address = e.x[at->rs1] + static_cast<std::uint32_t>(at->imm);
  const auto ram = ram_access<sizeof(T)>(e, at, address);
  if (ram.data == nullptr) [[unlikely]]
    return e.hart->slow_load(at, address, sizeof(T), std::is_signed_v<T>);
  T value;
  std::memcpy(&value, ram.data, sizeof value);
  e.x[at->rd] = static_cast<std::uint32_t>(static_cast<std::int32_t>(value));
  if constexpr (sizeof(T) > 1) {
    if (crosses_word(address, sizeof(T))) [[unlikely]]
      misaligned_load(e, at);
  }
  return next(e, at);
}

template <typename T>
const Instruction* store(Execution& e, const Instruction* at) {
  const auto address = e.x[at->rs1] + static_cast<std::uint32_t>(at->imm);
  const auto value = static_cast<T>(e.x[at->rs2]);
  const auto ram = ram_access<sizeof(T)>(e, at, address);
  if (ram.data == nullptr) [[unlikely]]
    return e.hart->slow_store(at, address, sizeof(T), e.x[at->rs2]);
  std::memcpy(ram.data, &value, sizeof value);
  std::uint8_t marks = ram.marks[0];
  if constexpr (sizeof(T) > 1) {
    if (crosses_word(address, sizeof(T))) [[unlikely]] {
      e.extra_cycles += kMisalignedExtra;
      marks |= ram.marks[1];
    }
  }
  if (marks != 0) [[unlikely]]
    return e.hart->marked_store(at, address, sizeof(T));
  return next(e, at);
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
const Instruction* event_load(Execution& e, const Instruction* at) {
  return e.hart->event_load(at);
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
    case Op::lb:
      return load<std::int8_t>;
    case Op::lh:
      return load<std::int16_t>;
    case Op::lw:
      return load<std::int32_t>;
    case Op::p_elw:
      return event_load;
    case Op::lbu:
      return load<std::uint8_t>;
    case Op::lhu:
      return load<std::uint16_t>;
    case Op::sb:
      return store<std::uint8_t>;
    case Op::sh:
      return store<std::uint16_t>;
    case Op::sw:
      return store<std::uint32_t>;
    case Op::addi:
      return with_immediate<f::add>;
    case Op::slti:
      return with_immediate<f::slt>;
    case Op::sltiu:
      return with_immediate<f::sltu>;
    case Op::xori:
      return with_immediate<f::bit_xor>;
    case Op::ori:
      return with_immediate<f::bit_or>;
    case Op::andi:
      return with_immediate<f::bit_and>;
    case Op::slli:
      return with_immediate<f::sll>;
    case Op::srli:
      return with_immediate<f::srl>;
    case Op::srai:
      return with_immediate<f::sra>;
    case Op::add:
      return with_register<f::add>;
    case Op::sub:
      return with_register<f::sub>;
    case Op::sll:
      return with_register<f::sll>;
    case Op::slt:
      return with_register<f::slt>;
    case Op::sltu:
      return with_register<f::sltu>;
    case Op::xor_:
      return with_register<f::bit_xor>;
    case Op::srl:
      return with_register<f::srl>;
    case Op::sra:
      return with_register<f::sra>;
    case Op::or_:
      return with_register<f::bit_or>;
    case Op::and_:
      return with_register<f::bit_and>;
    case Op::fence:
      return nothing;
    case Op::fence_i:
      return fence_instructions;
    case Op::ecall:
      return environment_call;
    case Op::ebreak:
      return breakpoint;
    case Op::mul:
      return with_register<f::mul>;
    case Op::mulh:
      return with_register<f::mulh>;
    case Op::mulhsu:
      return with_register<f::mulhsu>;
    case Op::mulhu:
      return with_register<f::mulhu>;
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
