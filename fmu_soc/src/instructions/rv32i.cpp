// SPDX-License-Identifier: Apache-2.0
//
// Execution and lowering of the operations in isa/rv32i.decode (RV32I).
#include "instructions/load_store.hpp"

#include "instructions/operation.hpp"
#include "mebots/assert.hpp"
#ifdef MEBOTS_TRANSLATES
#include "instructions/lowering.hpp"
#endif

namespace mebots::soc::rv32i {
namespace {

#ifdef MEBOTS_TRANSLATES
using namespace lowering;
#endif

// Instructions that load constants. The decoder has already added the pc to the immediate of auipc.

const Instruction* execute_lui(Execution& e, const Instruction* at) {
  e.x[at->rd] = static_cast<Word>(at->imm);
  return next(e, at);
}
const Instruction* execute_auipc(Execution& e, const Instruction* at) {
  return execute_lui(e, at);
}

#ifdef MEBOTS_TRANSLATES
void emit_lui(Assembler& c, const Instruction* at) {
  c.registers.set(at->rd, static_cast<std::uint32_t>(at->imm));
}
void emit_auipc(Assembler& c, const Instruction* at) {
  emit_lui(c, at);
}
#endif

// Jumps and branches.

const Instruction* leave_to(Execution& e, const Instruction* at, Word target) {
  MEBOTS_ASSERT(is_jump(at->op) && at->rd != 0);
  e.x[at->rd] = at[1].pc;
  e.pc = target;
  e.jumped = at->rs2 == 0;
  e.redirected = true;
  e.exit = at + 1;
  e.link = &at->link;  // the link of a jalr is its last target
  return nullptr;
}
const Instruction* execute_jal(Execution& e, const Instruction* at) {
  return leave_to(e, at, static_cast<Word>(at->imm));
}
const Instruction* execute_jalr(Execution& e, const Instruction* at) {
  return leave_to(e, at, (e.x[at->rs1] + static_cast<Word>(at->imm)) & ~1U);
}
constexpr bool execute_beq(Word a, Word b) {
  return a == b;
}
constexpr bool execute_bne(Word a, Word b) {
  return a != b;
}
constexpr bool execute_blt(Word a, Word b) {
  return as_signed(a) < as_signed(b);
}
constexpr bool execute_bge(Word a, Word b) {
  return as_signed(a) >= as_signed(b);
}
constexpr bool execute_bltu(Word a, Word b) {
  return a < b;
}
constexpr bool execute_bgeu(Word a, Word b) {
  return a >= b;
}
const Instruction* execute_end_of_block(Execution& e, const Instruction* at) {
  e.pc = at->pc;
  e.exit = at;
  e.link = &at->link;
  return nullptr;
}

#ifdef MEBOTS_TRANSLATES
void emit_jal(Assembler& c, const Instruction* at) {
  if (at->rd != kNoRegister) c.registers.set(at->rd, at[1].pc);
  c.edges.jump(at, static_cast<std::uint32_t>(at->imm), at->rs2 == 0);
}
/// Returns false if rs2 is not 0. The decoder then found that the instruction before the jalr hides the cost of an
/// unaligned target. The interpreter executes this rare case.
bool emit_jalr(Assembler& c, const Instruction* at) {
  if (at->rs2 != 0) return false;
  const auto base = c.registers.value(at->rs1, eax);
  c.lea(eax, ptr[base.cvt64() + at->imm]);
  c.and_(eax, ~1U);
  if (at->rd != kNoRegister) c.registers.set(at->rd, at[1].pc);
  c.edges.jump_indirect(at);
  return true;
}
/// Writes host code for a conditional branch. `jump(label)` must write a jump that is taken if the flags of rs1 - rs2
/// are those of a taken branch.
template <typename Jump>
void emit_branch(Assembler& c, const Instruction* at, Jump jump) {
  emit_compare(c, at->rs1, at->rs2);
  c.edges.branch(at, jump);
}
void emit_beq(Assembler& c, const Instruction* at) {
  emit_branch(c, at, [&](const Label& taken) { c.je(taken, kNear); });
}
void emit_bne(Assembler& c, const Instruction* at) {
  emit_branch(c, at, [&](const Label& taken) { c.jne(taken, kNear); });
}
void emit_blt(Assembler& c, const Instruction* at) {
  emit_branch(c, at, [&](const Label& taken) { c.jl(taken, kNear); });
}
void emit_bge(Assembler& c, const Instruction* at) {
  emit_branch(c, at, [&](const Label& taken) { c.jge(taken, kNear); });
}
void emit_bltu(Assembler& c, const Instruction* at) {
  emit_branch(c, at, [&](const Label& taken) { c.jb(taken, kNear); });
}
void emit_bgeu(Assembler& c, const Instruction* at) {
  emit_branch(c, at, [&](const Label& taken) { c.jae(taken, kNear); });
}
void emit_end_of_block(Assembler& c, const Instruction* at) {
  c.edges.fall_through(at, at->link, at->pc, true);
}
#endif

// Operations with an immediate.

constexpr Word execute_addi(Word a, Word b) {
  return a + b;
}
constexpr Word execute_slti(Word a, Word b) {
  return as_signed(a) < as_signed(b) ? 1U : 0U;
}
constexpr Word execute_sltiu(Word a, Word b) {
  return a < b ? 1U : 0U;
}
constexpr Word execute_xori(Word a, Word b) {
  return a ^ b;
}
constexpr Word execute_ori(Word a, Word b) {
  return a | b;
}
constexpr Word execute_andi(Word a, Word b) {
  return a & b;
}
constexpr Word execute_slli(Word a, Word b) {
  return a << (b & 31U);
}
constexpr Word execute_srli(Word a, Word b) {
  return a >> (b & 31U);
}
constexpr Word execute_srai(Word a, Word b) {
  return static_cast<Word>(as_signed(a) >> (b & 31U));
}

#ifdef MEBOTS_TRANSLATES
void emit_addi(Assembler& c, const Instruction* at) {
  if (at->rs1 == 0) {
    c.registers.set(at->rd, static_cast<std::uint32_t>(at->imm));
  } else if (at->rd == at->rs1 && !c.registers.in_vector(at->rd)) {
    if (at->imm != 0) c.add(c.registers.operand(at->rd), static_cast<std::uint32_t>(at->imm));
  } else {
    const auto to = c.registers.place(at->rd, eax);
    if (c.registers.in_host(at->rs1) && at->imm != 0) {
      c.lea(to, ptr[c.registers.host(at->rs1).cvt64() + at->imm]);
    } else {
      c.registers.copy(to, at->rs1);
      if (at->imm != 0) c.add(to, static_cast<std::uint32_t>(at->imm));
    }
    c.registers.finish(at->rd, to);
  }
}
/// Writes code that sets the host's flags to those of rs1 - immediate.
void emit_compare_immediate(Assembler& c, const Instruction* at) {
  if (at->rs1 == 0) {
    c.mov(eax, 0);
    c.cmp(eax, static_cast<std::uint32_t>(at->imm));
  } else {
    c.cmp(c.registers.source(at->rs1, eax), static_cast<std::uint32_t>(at->imm));
  }
}
void emit_slti(Assembler& c, const Instruction* at) {
  emit_compare_immediate(c, at);
  finish_set(c, at->rd, [&] { c.setl(al); });
}
void emit_sltiu(Assembler& c, const Instruction* at) {
  emit_compare_immediate(c, at);
  finish_set(c, at->rd, [&] { c.setb(al); });
}
void emit_xori(Assembler& c, const Instruction* at) {
  emit_immediate(c, at, [&](const Reg32& to, std::uint32_t value) { c.xor_(to, value); });
}
void emit_ori(Assembler& c, const Instruction* at) {
  emit_immediate(c, at, [&](const Reg32& to, std::uint32_t value) { c.or_(to, value); });
}
void emit_andi(Assembler& c, const Instruction* at) {
  emit_immediate(c, at, [&](const Reg32& to, std::uint32_t value) { c.and_(to, value); });
}
void emit_slli(Assembler& c, const Instruction* at) {
  emit_immediate(c, at, [&](const Reg32& to, std::uint32_t value) { c.shl(to, static_cast<int>(value & 31U)); });
}
void emit_srli(Assembler& c, const Instruction* at) {
  emit_immediate(c, at, [&](const Reg32& to, std::uint32_t value) { c.shr(to, static_cast<int>(value & 31U)); });
}
void emit_srai(Assembler& c, const Instruction* at) {
  emit_immediate(c, at, [&](const Reg32& to, std::uint32_t value) { c.sar(to, static_cast<int>(value & 31U)); });
}
#endif

// Operations with two registers.

constexpr Word execute_add(Word a, Word b) {
  return a + b;
}
constexpr Word execute_sub(Word a, Word b) {
  return a - b;
}
constexpr Word execute_sll(Word a, Word b) {
  return a << (b & 31U);
}
constexpr Word execute_slt(Word a, Word b) {
  return as_signed(a) < as_signed(b) ? 1U : 0U;
}
constexpr Word execute_sltu(Word a, Word b) {
  return a < b ? 1U : 0U;
}
constexpr Word execute_xor(Word a, Word b) {
  return a ^ b;
}
constexpr Word execute_srl(Word a, Word b) {
  return a >> (b & 31U);
}
constexpr Word execute_sra(Word a, Word b) {
  return static_cast<Word>(as_signed(a) >> (b & 31U));
}
constexpr Word execute_or(Word a, Word b) {
  return a | b;
}
constexpr Word execute_and(Word a, Word b) {
  return a & b;
}

#ifdef MEBOTS_TRANSLATES
void emit_add(Assembler& c, const Instruction* at) {
  const auto [a, b] = at->rd == at->rs2 ? std::pair{at->rs2, at->rs1} : std::pair{at->rs1, at->rs2};
  if (a == 0 || b == 0) {  // mv
    const auto to = c.registers.place(at->rd, eax);
    c.registers.copy(to, a == 0 ? b : a);
    c.registers.finish(at->rd, to);
  } else if (at->rd == a && c.registers.in_vector(a)) {
    c.paddd(c.registers.vector(a), c.registers.in_vector_for(b, xmm0));
  } else if (at->rd == a) {
    c.add(c.registers.operand(a), c.registers.value(b, eax));
  } else {
    const auto left = c.registers.value(a, eax);
    const auto right = c.registers.value(b, ecx);
    const auto to = c.registers.place(at->rd, eax);
    c.lea(to, ptr[left.cvt64() + right.cvt64()]);
    c.registers.finish(at->rd, to);
  }
}
void emit_sub(Assembler& c, const Instruction* at) {
  emit_binary(c, at, [&](const Reg32& to, const Xbyak::Operand& from) { c.sub(to, from); });
}
void emit_sll(Assembler& c, const Instruction* at) {
  emit_shift(c, at, [&](const Reg32& to, const Reg32& from, const Reg32& by) { c.shlx(to, from, by); });
}
void emit_slt(Assembler& c, const Instruction* at) {
  emit_set(c, at, [&] { c.setl(al); });
}
void emit_sltu(Assembler& c, const Instruction* at) {
  emit_set(c, at, [&] { c.setb(al); });
}
void emit_xor(Assembler& c, const Instruction* at) {
  emit_binary(c, at, [&](const Reg32& to, const Xbyak::Operand& from) { c.xor_(to, from); });
}
void emit_srl(Assembler& c, const Instruction* at) {
  emit_shift(c, at, [&](const Reg32& to, const Reg32& from, const Reg32& by) { c.shrx(to, from, by); });
}
void emit_sra(Assembler& c, const Instruction* at) {
  emit_shift(c, at, [&](const Reg32& to, const Reg32& from, const Reg32& by) { c.sarx(to, from, by); });
}
void emit_or(Assembler& c, const Instruction* at) {
  emit_binary(c, at, [&](const Reg32& to, const Xbyak::Operand& from) { c.or_(to, from); });
}
void emit_and(Assembler& c, const Instruction* at) {
  emit_binary(c, at, [&](const Reg32& to, const Xbyak::Operand& from) { c.and_(to, from); });
}
#endif

// A fence only takes time, because stores are immediately visible, also to the decoder.

const Instruction* execute_fence(Execution& e, const Instruction* at) {
  return next(e, at);
}

#ifdef MEBOTS_TRANSLATES
void emit_fence(Assembler& /*c*/, const Instruction* /*at*/) {}
#endif

}  // namespace

constinit const Operation kOperations[] = {
#include "fmu_soc_isa/rv32i.inc"
};

}  // namespace mebots::soc::rv32i
