// SPDX-License-Identifier: Apache-2.0
//
// Execution and lowering of the operations in isa/zb.decode (Zba, Zbb, Zbc and Zbs).
#include "instructions/operation.hpp"

#include "mebots/assert.hpp"
#ifdef MEBOTS_TRANSLATES
#include "instructions/lowering.hpp"

#include <xbyak/xbyak_util.h>
#endif

#include <bit>

namespace mebots::soc::zb {
namespace {

#ifdef MEBOTS_TRANSLATES
using namespace lowering;
#endif

// Operations of Zba, which compute addresses of array elements.

constexpr Word execute_sh1add(Word a, Word b) {
  return (a << 1) + b;
}
constexpr Word execute_sh2add(Word a, Word b) {
  return (a << 2) + b;
}
constexpr Word execute_sh3add(Word a, Word b) {
  return (a << 3) + b;
}

#ifdef MEBOTS_TRANSLATES
void emit_shifted_add(Assembler& c, const Instruction* at, int scale) {
  const auto index = c.registers.value(at->rs1, eax);
  const auto base = c.registers.value(at->rs2, ecx);
  const auto to = c.registers.place(at->rd, eax);
  c.lea(to, ptr[base.cvt64() + index.cvt64() * scale]);
  c.registers.finish(at->rd, to);
}
void emit_sh1add(Assembler& c, const Instruction* at) {
  emit_shifted_add(c, at, 2);
}
void emit_sh2add(Assembler& c, const Instruction* at) {
  emit_shifted_add(c, at, 4);
}
void emit_sh3add(Assembler& c, const Instruction* at) {
  emit_shifted_add(c, at, 8);
}
#endif

// Operations of Zbb, except for those that Xpulp also has (xpulp.cpp).

constexpr Word execute_andn(Word a, Word b) {
  return a & ~b;
}
constexpr Word execute_orn(Word a, Word b) {
  return a | ~b;
}
constexpr Word execute_xnor(Word a, Word b) {
  return ~(a ^ b);
}
/// Returns the number of leading zeros, which is 32 for the word 0.
constexpr Word execute_clz(Word a) {
  return static_cast<Word>(std::countl_zero(a));
}
constexpr Word execute_rol(Word a, Word b) {
  return std::rotl(a, static_cast<int>(b & 31U));
}
/// Replaces each byte other than 0 by 255.
constexpr Word execute_orc_b(Word a) {
  const auto set = (((a & 0x7f7f7f7fU) + 0x7f7f7f7fU) | a) >> 7 & 0x01010101U;
  return set * 255U;
}
constexpr Word execute_rev8(Word a) {
  return a << 24 | (a & 0xff00U) << 8 | (a >> 8 & 0xff00U) | a >> 24;
}

#ifdef MEBOTS_TRANSLATES
void emit_andn(Assembler& c, const Instruction* at) {
  const auto a = c.registers.value(at->rs1, eax);
  const auto b = c.registers.value(at->rs2, ecx);
  const auto to = c.registers.place(at->rd, eax);
  c.andn(to, b, a);
  c.registers.finish(at->rd, to);
}
void emit_orn(Assembler& c, const Instruction* at) {
  c.registers.copy(eax, at->rs2);
  c.not_(eax);
  c.or_(eax, c.registers.value(at->rs1, ecx));
  c.registers.finish(at->rd, eax);
}
void emit_xnor(Assembler& c, const Instruction* at) {
  c.registers.copy(eax, at->rs1);
  c.xor_(eax, c.registers.value(at->rs2, ecx));
  c.not_(eax);
  c.registers.finish(at->rd, eax);
}
void emit_clz(Assembler& c, const Instruction* at) {
  emit_unary(c, at, [&](const Reg32& to) { c.lzcnt(to, to); });
}
void emit_rol(Assembler& c, const Instruction* at) {
  c.registers.copy(eax, at->rs1);
  c.registers.copy(ecx, at->rs2);
  c.rol(eax, cl);
  c.registers.finish(at->rd, eax);
}
void emit_orc_b(Assembler& c, const Instruction* at) {
  emit_unary(c, at, [&](const Reg32& to) {
    c.mov(ecx, to);
    c.and_(ecx, 0x7f7f7f7f);
    c.add(ecx, 0x7f7f7f7f);
    c.or_(to, ecx);
    c.shr(to, 7);
    c.and_(to, 0x01010101);
    c.imul(to, to, 255);
  });
}
void emit_rev8(Assembler& c, const Instruction* at) {
  emit_unary(c, at, [&](const Reg32& to) { c.bswap(to); });
}
#endif

// Operations of Zbc, which multiply without carries.

constexpr std::uint64_t carryless_product(Word a, Word b) {
  std::uint64_t product = 0;
  for (unsigned i = 0; i < 32; ++i) product ^= (b >> i & 1U) != 0 ? std::uint64_t{a} << i : 0U;
  return product;
}
constexpr Word execute_clmul(Word a, Word b) {
  return static_cast<Word>(carryless_product(a, b));
}
constexpr Word execute_clmulh(Word a, Word b) {
  return static_cast<Word>(carryless_product(a, b) >> 32);
}
/// Returns bits 62 to 31 of the product without carries.
constexpr Word execute_clmulr(Word a, Word b) {
  return static_cast<Word>(carryless_product(a, b) >> 31);
}

#ifdef MEBOTS_TRANSLATES
/// Writes code for a multiplication without carries. Returns false if the host's processor has no such instruction.
bool emit_carryless(Assembler& c, const Instruction* at, int shift) {
  if (!translate::host_processor().has(Xbyak::util::Cpu::tPCLMULQDQ)) return false;
  for (const auto& [vector, reg] : {std::pair{xmm0, at->rs1}, std::pair{xmm1, at->rs2}}) {
    c.registers.copy(eax, reg);
    c.movd(vector, eax);  // clears the upper bits
  }
  c.pclmulqdq(xmm0, xmm1, 0);
  c.movq(rax, xmm0);
  if (shift != 0) c.shr(rax, shift);
  c.registers.finish(at->rd, eax);
  return true;
}
bool emit_clmul(Assembler& c, const Instruction* at) {
  return emit_carryless(c, at, 0);
}
bool emit_clmulh(Assembler& c, const Instruction* at) {
  return emit_carryless(c, at, 32);
}
bool emit_clmulr(Assembler& c, const Instruction* at) {
  return emit_carryless(c, at, 31);
}
#endif

// Operations of Zbs on one bit. The low five bits of the second operand are the number of the bit.

constexpr Word bit(Word number) {
  return Word{1} << (number & 31U);
}
constexpr Word execute_bclr(Word a, Word b) {
  return a & ~bit(b);
}
constexpr Word execute_bext(Word a, Word b) {
  return a >> (b & 31U) & 1U;
}
constexpr Word execute_binv(Word a, Word b) {
  return a ^ bit(b);
}
constexpr Word execute_bset(Word a, Word b) {
  return a | bit(b);
}

#ifdef MEBOTS_TRANSLATES
/// Writes code for an operation on one bit. `apply(to, number)` must write the host instruction. Like the guest
/// instruction, it uses the number modulo 32.
template <typename Apply>
void emit_bit(Assembler& c, const Instruction* at, Apply apply) {
  c.registers.copy(eax, at->rs1);
  copy_second(c, at, ecx);
  apply(eax, ecx);
  c.registers.finish(at->rd, eax);
}
void emit_bclr(Assembler& c, const Instruction* at) {
  emit_bit(c, at, [&](const Reg32& to, const Reg32& number) { c.btr(to, number); });
}
void emit_bext(Assembler& c, const Instruction* at) {
  emit_bit(c, at, [&](const Reg32& to, const Reg32& number) {
    c.shrx(to, to, number);
    c.and_(to, 1);
  });
}
void emit_binv(Assembler& c, const Instruction* at) {
  emit_bit(c, at, [&](const Reg32& to, const Reg32& number) { c.btc(to, number); });
}
void emit_bset(Assembler& c, const Instruction* at) {
  emit_bit(c, at, [&](const Reg32& to, const Reg32& number) { c.bts(to, number); });
}
#endif

}  // namespace

constinit const Operation kOperations[] = {
#include "fmu_soc_isa/zb.inc"
};

}  // namespace mebots::soc::zb
