// SPDX-License-Identifier: Apache-2.0
//
// Execution and lowering of the operations in isa/rv32m.decode (M extension).
#include "instructions/operation.hpp"

#include "mebots/assert.hpp"
#ifdef MEBOTS_TRANSLATES
#include "instructions/lowering.hpp"
#endif

namespace mebots::soc::rv32m {
namespace {

#ifdef MEBOTS_TRANSLATES
using namespace lowering;
#endif

// Products

constexpr Word execute_mul(Word a, Word b) {
  return a * b;
}
constexpr Word execute_mulh(Word a, Word b) {
  return static_cast<Word>((std::int64_t{as_signed(a)} * std::int64_t{as_signed(b)}) >> 32);
}
constexpr Word execute_mulhsu(Word a, Word b) {
  return static_cast<Word>((std::int64_t{as_signed(a)} * static_cast<std::int64_t>(b)) >> 32);
}
constexpr Word execute_mulhu(Word a, Word b) {
  return static_cast<Word>((std::uint64_t{a} * std::uint64_t{b}) >> 32);
}

#ifdef MEBOTS_TRANSLATES
void emit_mul(Assembler& c, const Instruction* at) {
  emit_binary(c, at, [&](const Reg32& to, const Xbyak::Operand& from) { c.imul(to, from); });
}
void emit_multiply_high(Assembler& c, const Instruction* at, bool first_sign, bool second_sign) {
  const auto widen = [&c](const Xbyak::Reg64& to, unsigned reg, bool sign) {
    if (sign && reg != 0) {
      c.movsxd(to, c.registers.source(reg, to.cvt32()));
    } else {
      c.registers.copy(to.cvt32(), reg);
    }
  };
  widen(rax, at->rs1, first_sign);
  widen(rcx, at->rs2, second_sign);
  c.imul(rax, rcx);
  c.shr(rax, 32);
  c.registers.finish(at->rd, eax);
}
void emit_mulh(Assembler& c, const Instruction* at) {
  emit_multiply_high(c, at, true, true);
}
void emit_mulhsu(Assembler& c, const Instruction* at) {
  emit_multiply_high(c, at, true, false);
}
void emit_mulhu(Assembler& c, const Instruction* at) {
  emit_multiply_high(c, at, false, false);
}
#endif

// Division by zero returns all ones, and its remainder is the dividend. The overflow -2^31 / -1 returns -2^31, and its
// remainder is 0.

constexpr Word execute_div(Word a, Word b) {
  if (b == 0) return ~Word{0};
  if (b == ~Word{0}) return Word{0} - a;
  return static_cast<Word>(as_signed(a) / as_signed(b));
}
constexpr Word execute_divu(Word a, Word b) {
  return b == 0 ? ~Word{0} : a / b;
}
constexpr Word execute_rem(Word a, Word b) {
  if (b == 0) return a;
  if (b == ~Word{0}) return 0;
  return static_cast<Word>(as_signed(a) % as_signed(b));
}
constexpr Word execute_remu(Word a, Word b) {
  return b == 0 ? a : a % b;
}

#ifdef MEBOTS_TRANSLATES
/// Writes code that counts the cycles of a division by ecx: see divide_extra_signed() and divide_extra_unsigned(). The
/// code changes eax and edx.
void emit_divide_cycles(Assembler& c, bool is_signed) {
  if (is_signed) {
    c.mov(edx, ecx);
    c.sar(edx, 31);
    c.mov(eax, edx);
    c.xor_(edx, ecx);
    c.lzcnt(edx, edx);
    c.add(edx, eax);  // one less if negative
  } else {
    c.lzcnt(edx, ecx);
  }
  c.cycles.spend(rdx);
}
void emit_divide(Assembler& c, const Instruction* at, bool remainder) {
  MEBOTS_ASSERT(is_divide(at->op));
  const bool is_signed = traits_of(at->op).sign;
  c.registers.copy(ecx, at->rs2);
  emit_divide_cycles(c, is_signed);
  c.registers.copy(eax, at->rs1);
  Label by_zero;
  Label done;
  c.test(ecx, ecx);
  c.jz(by_zero, kNear);
  if (is_signed) {
    // In 64 bits, -2^31 / -1 does not overflow.
    c.movsxd(rax, eax);
    c.movsxd(rcx, ecx);
    c.cqo();
    c.idiv(rcx);
  } else {
    c.xor_(edx, edx);
    c.div(ecx);
  }
  if (remainder) c.mov(eax, edx);
  c.L(done);
  c.registers.finish(at->rd, eax);
  c.defer_cold([&c, by_zero, done, remainder]() mutable {
    c.L(by_zero);
    if (!remainder) c.mov(eax, ~0U);  // the remainder is the dividend, which is in eax
    c.jmp(done, kNear);
  });
}
void emit_div(Assembler& c, const Instruction* at) {
  emit_divide(c, at, false);
}
void emit_divu(Assembler& c, const Instruction* at) {
  emit_divide(c, at, false);
}
void emit_rem(Assembler& c, const Instruction* at) {
  emit_divide(c, at, true);
}
void emit_remu(Assembler& c, const Instruction* at) {
  emit_divide(c, at, true);
}
#endif

}  // namespace

constinit const Operation kOperations[] = {
#include "fmu_soc_isa/rv32m.inc"
};

}  // namespace mebots::soc::rv32m
