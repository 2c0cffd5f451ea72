// SPDX-License-Identifier: Apache-2.0
//
// Execution and lowering of the operations in isa/xpulp_simd.decode (Xpulp v2 on two halves or four bytes of a word,
// called parts). Part 0 is the lowest part. Lowerings use the low 32 bits of SSE registers.
#include "instructions/operation.hpp"

#include "mebots/assert.hpp"
#ifdef MEBOTS_TRANSLATES
#include "instructions/lowering.hpp"

#include <xbyak/xbyak_util.h>

#include <optional>
#endif

#include <type_traits>

namespace mebots::soc::xpulp_simd {
namespace {

#ifdef MEBOTS_TRANSLATES
using namespace lowering;
#endif

template <Op kOp>
using Signed = std::conditional_t<traits_of(kOp).parts == 4, std::int8_t, std::int16_t>;
template <Op kOp>
using Unsigned = std::make_unsigned_t<Signed<kOp>>;

template <typename T>
inline constexpr unsigned kParts = 4 / sizeof(T);
template <typename T>
inline constexpr unsigned kPartBits = 8 * sizeof(T);

template <typename T>
constexpr T part(Word a, unsigned index) {
  return static_cast<T>(a >> (index * kPartBits<T>));
}
template <typename T>
constexpr Word at_part(T value, unsigned index) {
  return Word{static_cast<std::make_unsigned_t<T>>(value)} << (index * kPartBits<T>);
}

/// Applies `compute` to each pair of parts, and returns the word with the results.
template <typename T, typename Compute>
constexpr Word on_parts(Word a, Word b, Compute compute) {
  Word result = 0;
  for (unsigned i = 0; i < kParts<T>; ++i) {
    result |= at_part<T>(static_cast<T>(compute(part<T>(a, i), part<T>(b, i))), i);
  }
  return result;
}

#ifdef MEBOTS_TRANSLATES
bool on_bytes(Op op) {
  return traits_of(op).parts == 4;
}
/// Writes code that loads the second operand into ecx.
void load_second(Assembler& c, const Instruction* at) {
  MEBOTS_ASSERT(is_simd(at->op));
  const auto from = operand_of(*at);
  if (from == Operand::immediate) {
    c.mov(ecx, static_cast<std::uint32_t>(at->imm));
    return;
  }
  c.registers.copy(ecx, at->rs2);
  if (from != Operand::scalar) return;
  if (on_bytes(at->op)) {
    c.movzx(ecx, cl);
    c.imul(ecx, ecx, 0x01010101);
  } else {
    c.movzx(ecx, cx);
    c.imul(ecx, ecx, 0x00010001);
  }
}
/// Writes code for one host instruction on bytes or halves. `apply(to, from)` must write `to = to op from`.
template <typename Apply>
void emit_packed(Assembler& c, const Instruction* at, Apply apply) {
  c.registers.copy(eax, at->rs1);
  load_second(c, at);
  c.movd(xmm0, eax);
  c.movd(xmm1, ecx);
  apply(xmm0, xmm1);
  c.movd(eax, xmm0);
  c.registers.finish(at->rd, eax);
}
#endif

// Sums, minimum and maximum of parts.

template <Op kOp>
constexpr Word execute_pv_add(Word a, Word b) {
  return on_parts<Unsigned<kOp>>(a, b, [](auto x, auto y) { return x + y; });
}
template <Op kOp>
constexpr Word execute_pv_sub(Word a, Word b) {
  return on_parts<Unsigned<kOp>>(a, b, [](auto x, auto y) { return x - y; });
}
template <Op kOp>
constexpr Word execute_pv_min(Word a, Word b) {
  return on_parts<Signed<kOp>>(a, b, [](auto x, auto y) { return x < y ? x : y; });
}
template <Op kOp>
constexpr Word execute_pv_minu(Word a, Word b) {
  return on_parts<Unsigned<kOp>>(a, b, [](auto x, auto y) { return x < y ? x : y; });
}
template <Op kOp>
constexpr Word execute_pv_max(Word a, Word b) {
  return on_parts<Signed<kOp>>(a, b, [](auto x, auto y) { return x > y ? x : y; });
}
template <Op kOp>
constexpr Word execute_pv_maxu(Word a, Word b) {
  return on_parts<Unsigned<kOp>>(a, b, [](auto x, auto y) { return x > y ? x : y; });
}
/// Returns half of the sum of each pair of parts. The sum wraps before it is halved.
template <Op kOp>
constexpr Word execute_pv_avg(Word a, Word b) {
  return on_parts<Signed<kOp>>(a, b, [](auto x, auto y) { return static_cast<decltype(x)>(x + y) >> 1; });
}
template <Op kOp>
constexpr Word execute_pv_avgu(Word a, Word b) {
  return on_parts<Unsigned<kOp>>(a, b, [](auto x, auto y) { return static_cast<decltype(x)>(x + y) >> 1; });
}
template <Op kOp>
constexpr Word execute_pv_abs(Word a) {
  return on_parts<Signed<kOp>>(a, 0, [](auto x, auto) { return x < 0 ? -x : x; });
}

#ifdef MEBOTS_TRANSLATES
void emit_pv_add(Assembler& c, const Instruction* at) {
  emit_packed(c, at, [&](const Xmm& to, const Xmm& from) { on_bytes(at->op) ? c.paddb(to, from) : c.paddw(to, from); });
}
void emit_pv_sub(Assembler& c, const Instruction* at) {
  emit_packed(c, at, [&](const Xmm& to, const Xmm& from) { on_bytes(at->op) ? c.psubb(to, from) : c.psubw(to, from); });
}
void emit_pv_min(Assembler& c, const Instruction* at) {
  emit_packed(c, at,
              [&](const Xmm& to, const Xmm& from) { on_bytes(at->op) ? c.pminsb(to, from) : c.pminsw(to, from); });
}
void emit_pv_minu(Assembler& c, const Instruction* at) {
  emit_packed(c, at,
              [&](const Xmm& to, const Xmm& from) { on_bytes(at->op) ? c.pminub(to, from) : c.pminuw(to, from); });
}
void emit_pv_max(Assembler& c, const Instruction* at) {
  emit_packed(c, at,
              [&](const Xmm& to, const Xmm& from) { on_bytes(at->op) ? c.pmaxsb(to, from) : c.pmaxsw(to, from); });
}
void emit_pv_maxu(Assembler& c, const Instruction* at) {
  emit_packed(c, at,
              [&](const Xmm& to, const Xmm& from) { on_bytes(at->op) ? c.pmaxub(to, from) : c.pmaxuw(to, from); });
}
/// The sum of two parts wraps before the code halves it.
void emit_average(Assembler& c, const Instruction* at, bool sign) {
  c.registers.copy(eax, at->rs1);
  load_second(c, at);
  c.movd(xmm0, eax);
  c.movd(xmm1, ecx);
  if (on_bytes(at->op)) {
    c.paddb(xmm0, xmm1);
    c.punpcklbw(xmm0, xmm0);  // moves each byte to the upper half of a 16-bit word
    sign ? c.psraw(xmm0, 9) : c.psrlw(xmm0, 9);
    sign ? c.packsswb(xmm0, xmm0) : c.packuswb(xmm0, xmm0);
  } else {
    c.paddw(xmm0, xmm1);
    sign ? c.psraw(xmm0, 1) : c.psrlw(xmm0, 1);
  }
  c.movd(eax, xmm0);
  c.registers.finish(at->rd, eax);
}
void emit_pv_avg(Assembler& c, const Instruction* at) {
  emit_average(c, at, true);
}
void emit_pv_avgu(Assembler& c, const Instruction* at) {
  emit_average(c, at, false);
}
void emit_pv_abs(Assembler& c, const Instruction* at) {
  c.registers.copy(eax, at->rs1);
  c.movd(xmm0, eax);
  on_bytes(at->op) ? c.pabsb(xmm0, xmm0) : c.pabsw(xmm0, xmm0);
  c.movd(eax, xmm0);
  c.registers.finish(at->rd, eax);
}
#endif

// Shifts of each part.

template <Op kOp>
constexpr Word execute_pv_srl(Word a, Word b) {
  return on_parts<Unsigned<kOp>>(a, b,
                                 [](auto x, auto y) { return x >> (static_cast<unsigned>(y) % (8 * sizeof(x))); });
}
template <Op kOp>
constexpr Word execute_pv_sra(Word a, Word b) {
  return on_parts<Signed<kOp>>(a, b, [](auto x, auto y) { return x >> (static_cast<unsigned>(y) % (8 * sizeof(x))); });
}
template <Op kOp>
constexpr Word execute_pv_sll(Word a, Word b) {
  return on_parts<Unsigned<kOp>>(
      a, b, [](auto x, auto y) { return static_cast<unsigned>(x) << (static_cast<unsigned>(y) % (8 * sizeof(x))); });
}

#ifdef MEBOTS_TRANSLATES
enum class PartShift : std::uint8_t { left, right, right_signed };
/// Writes code that shifts all parts by the same number of places. Returns false for other shifts, which are rare.
bool emit_shift_parts(Assembler& c, const Instruction* at, PartShift shift) {
  const bool bytes = on_bytes(at->op);
  const auto from = operand_of(*at);
  if (from == Operand::reg || (from == Operand::scalar && bytes)) return false;
  c.registers.copy(eax, at->rs1);
  if (from == Operand::scalar) {
    c.registers.copy(ecx, at->rs2);
    c.and_(ecx, 15);
    c.movd(xmm0, eax);
    c.movd(xmm1, ecx);
    if (shift == PartShift::right) c.psrlw(xmm0, xmm1);
    if (shift == PartShift::right_signed) c.psraw(xmm0, xmm1);
    if (shift == PartShift::left) c.psllw(xmm0, xmm1);
    c.movd(eax, xmm0);
    c.registers.finish(at->rd, eax);
    return true;
  }
  const auto places = static_cast<int>(static_cast<unsigned>(at->imm) & (bytes ? 7U : 15U));
  const auto in_all = [bytes](std::uint32_t part) {
    return bytes ? (part & 0xffU) * 0x01010101U : (part & 0xffffU) * 0x00010001U;
  };
  if (shift == PartShift::right) {
    c.shr(eax, places);
    c.and_(eax, in_all((bytes ? 0xffU : 0xffffU) >> places));
  } else if (shift == PartShift::left) {
    c.shl(eax, places);
    c.and_(eax, in_all((bytes ? 0xffU : 0xffffU) << places));
  } else {
    c.movd(xmm0, eax);
    if (bytes) {
      c.punpcklbw(xmm0, xmm0);
      c.psraw(xmm0, 8 + places);
      c.packsswb(xmm0, xmm0);
    } else {
      c.psraw(xmm0, places);
    }
    c.movd(eax, xmm0);
  }
  c.registers.finish(at->rd, eax);
  return true;
}
bool emit_pv_srl(Assembler& c, const Instruction* at) {
  return emit_shift_parts(c, at, PartShift::right);
}
bool emit_pv_sra(Assembler& c, const Instruction* at) {
  return emit_shift_parts(c, at, PartShift::right_signed);
}
bool emit_pv_sll(Assembler& c, const Instruction* at) {
  return emit_shift_parts(c, at, PartShift::left);
}
#endif

// Logic

template <Op>
constexpr Word execute_pv_or(Word a, Word b) {
  return a | b;
}
template <Op>
constexpr Word execute_pv_xor(Word a, Word b) {
  return a ^ b;
}
template <Op>
constexpr Word execute_pv_and(Word a, Word b) {
  return a & b;
}

#ifdef MEBOTS_TRANSLATES
/// Writes code for a logical operation. `apply(to, from)` must write the host instruction for `to = to op from`.
template <typename Apply>
void emit_logic(Assembler& c, const Instruction* at, Apply apply) {
  c.registers.copy(eax, at->rs1);
  load_second(c, at);
  apply(eax, ecx);
  c.registers.finish(at->rd, eax);
}
void emit_pv_or(Assembler& c, const Instruction* at) {
  emit_logic(c, at, [&](const Reg32& to, const Reg32& from) { c.or_(to, from); });
}
void emit_pv_xor(Assembler& c, const Instruction* at) {
  emit_logic(c, at, [&](const Reg32& to, const Reg32& from) { c.xor_(to, from); });
}
void emit_pv_and(Assembler& c, const Instruction* at) {
  emit_logic(c, at, [&](const Reg32& to, const Reg32& from) { c.and_(to, from); });
}
#endif

// Comparisons. If the relation holds for a part, all bits of this part of the result are 1.

template <Op kOp>
constexpr Word execute_compare_parts(Word a, Word b) {
  using T = std::conditional_t<traits_of(kOp).sign, Signed<kOp>, Unsigned<kOp>>;
  return on_parts<T>(a, b, [](auto x, auto y) {
    constexpr auto kRelation = traits_of(kOp).relation;
    if constexpr (kRelation == Relation::eq) return x == y ? -1 : 0;
    if constexpr (kRelation == Relation::ne) return x != y ? -1 : 0;
    if constexpr (kRelation == Relation::gt) return x > y ? -1 : 0;
    if constexpr (kRelation == Relation::ge) return x >= y ? -1 : 0;
    if constexpr (kRelation == Relation::lt) return x < y ? -1 : 0;
    return x <= y ? -1 : 0;
  });
}

#ifdef MEBOTS_TRANSLATES
constexpr std::uint32_t kSignOfBytes = 0x80808080U;
constexpr std::uint32_t kSignOfHalves = 0x80008000U;

/// The host has no unsigned comparison. The code therefore inverts the sign bits of unsigned operands first.
void emit_compare_parts(Assembler& c, const Instruction* at) {
  MEBOTS_ASSERT(traits_of(at->op).kind == OpKind::simd_compare);
  const bool bytes = on_bytes(at->op);
  c.registers.copy(eax, at->rs1);
  load_second(c, at);
  const auto relation = traits_of(at->op).relation;
  if (!traits_of(at->op).sign) {
    const auto sign = bytes ? kSignOfBytes : kSignOfHalves;
    c.xor_(eax, sign);
    c.xor_(ecx, sign);
  }
  c.movd(xmm0, eax);
  c.movd(xmm1, ecx);
  const bool equal = relation == Relation::eq || relation == Relation::ne;
  const bool swapped = relation == Relation::ge || relation == Relation::lt;
  const bool inverted = relation == Relation::ne || relation == Relation::ge || relation == Relation::le;
  const auto& left = swapped ? xmm1 : xmm0;
  const auto& right = swapped ? xmm0 : xmm1;
  if (equal) {
    bytes ? c.pcmpeqb(left, right) : c.pcmpeqw(left, right);
  } else {
    bytes ? c.pcmpgtb(left, right) : c.pcmpgtw(left, right);
  }
  c.movd(eax, left);
  if (inverted) c.not_(eax);
  c.registers.finish(at->rd, eax);
}
#endif

// Dot products: the sum of the products of all pairs of parts. Some operations add this sum to rd.

template <Op kOp>
constexpr Word execute_accumulate_dot_product(Word sum, Word a, Word b) {
  using A = std::conditional_t<traits_of(kOp).sign, Signed<kOp>, Unsigned<kOp>>;
  using B = std::conditional_t<traits_of(kOp).second_sign, Signed<kOp>, Unsigned<kOp>>;
  for (unsigned i = 0; i < kParts<A>; ++i) {
    sum += static_cast<Word>(std::int32_t{part<A>(a, i)}) * static_cast<Word>(std::int32_t{part<B>(b, i)});
  }
  return sum;
}
template <Op kOp>
constexpr Word execute_dot_product(Word a, Word b) {
  return execute_accumulate_dot_product<kOp>(0, a, b);
}

#ifdef MEBOTS_TRANSLATES
/// Returns the encoding of the host instruction for dot products of unsigned and signed bytes, or nullopt if the host
/// has no such instruction.
std::optional<Xbyak::PreferredEncoding> host_dot_product() {
  using Xbyak::util::Cpu;
  const Cpu& cpu = translate::host_processor();
  if (cpu.has(Cpu::tAVX_VNNI)) return Xbyak::VexEncoding;
  if (cpu.has(Cpu::tAVX512_VNNI) && cpu.has(Cpu::tAVX512VL)) return Xbyak::EvexEncoding;
  return std::nullopt;
}

/// Writes the end of a dot product: rd = sum, or rd += sum. The code may change eax.
void finish_sum(Assembler& c, unsigned rd, bool accumulates, const Xbyak::Xmm& sum) {
  if (!accumulates) {
    c.registers.finish_vector(rd, sum);
  } else if (c.registers.in_vector(rd)) {
    c.paddd(c.registers.vector(rd), sum);
  } else {
    c.movd(eax, sum);
    c.add(c.registers.operand(rd), eax);
  }
}
/// Writes code for a dot product. Signed halves are multiplied by pmaddwd, other halves one by one. Bytes are first
/// extended to halves, because pmaddubsw saturates. Some hosts have an instruction that multiplies unsigned by signed
/// bytes.
void emit_dot_product(Assembler& c, const Instruction* at) {
  MEBOTS_ASSERT(is_dot_product(at->op));
  const bool accumulates = reads_rd(at->op);
  const bool left_signed = traits_of(at->op).sign;
  const bool right_signed = traits_of(at->op).second_sign;
  if (on_bytes(at->op)) {
    const auto left = c.registers.in_vector_for(at->rs1, xmm0);
    auto right = xmm1;
    if (operand_of(*at) == Operand::reg) {
      right = c.registers.in_vector_for(at->rs2, xmm1);
    } else {
      load_second(c, at);
      c.movd(xmm1, ecx);
    }
    if (const auto encoding = host_dot_product(); encoding && !left_signed && right_signed) {
      const auto sum = accumulates ? c.registers.in_vector_for(at->rd, xmm2) : xmm2;
      if (!accumulates) c.pxor(sum, sum);
      c.vpdpbusd(sum, left, right, *encoding);
      c.registers.finish_vector(at->rd, sum);
      return;
    }
    left_signed ? c.pmovsxbw(xmm0, left) : c.pmovzxbw(xmm0, left);
    right_signed ? c.pmovsxbw(xmm1, right) : c.pmovzxbw(xmm1, right);
    c.pmaddwd(xmm0, xmm1);
    c.pshufd(xmm1, xmm0, 1);
    c.paddd(xmm0, xmm1);
    finish_sum(c, at->rd, accumulates, xmm0);
    return;
  }
  if (left_signed) {
    load_second(c, at);
    c.movd(xmm1, ecx);
    if (c.registers.in_vector(at->rs1)) {
      c.movdqa(xmm0, c.registers.vector(at->rs1));
    } else {
      c.registers.copy(eax, at->rs1);
      c.movd(xmm0, eax);
    }
    c.pmaddwd(xmm0, xmm1);
    finish_sum(c, at->rd, accumulates, xmm0);
  } else {
    c.registers.copy(eax, at->rs1);
    load_second(c, at);
    c.mov(edx, eax);
    c.movzx(eax, ax);
    c.shr(edx, 16);
    c.push(rsi);
    c.mov(esi, ecx);
    right_signed ? c.movsx(ecx, cx) : c.movzx(ecx, cx);
    c.imul(eax, ecx);
    right_signed ? c.sar(esi, 16) : c.shr(esi, 16);
    c.imul(edx, esi);
    c.pop(rsi);
    c.add(eax, edx);
    c.movd(xmm0, eax);
    finish_sum(c, at->rd, accumulates, xmm0);
  }
}
void emit_accumulate_dot_product(Assembler& c, const Instruction* at) {
  emit_dot_product(c, at);
}
#endif

// Operations that copy parts.

/// Returns one part of `a`, extended to a word.
template <Op kOp>
constexpr Word execute_pv_extract(Word a, Word index) {
  return static_cast<Word>(std::int32_t{part<Signed<kOp>>(a, index % kParts<Signed<kOp>>)});
}
template <Op kOp>
constexpr Word execute_pv_extractu(Word a, Word index) {
  return part<Unsigned<kOp>>(a, index % kParts<Unsigned<kOp>>);
}
/// Returns `into` with one part replaced by the low part of `a`.
template <Op kOp>
constexpr Word execute_pv_insert(Word into, Word a, Word index) {
  using T = Unsigned<kOp>;
  const auto place = index % kParts<T>;
  return (into & ~at_part<T>(static_cast<T>(-1), place)) | at_part<T>(static_cast<T>(a), place);
}
/// Returns a word whose parts are copies of parts of `a`. Each part of `selectors` is the number of the part that is
/// copied there.
template <Op kOp>
constexpr Word execute_pv_shuffle(Word a, Word selectors) {
  return on_parts<Unsigned<kOp>>(selectors, 0, [a](auto selector, auto) {
    return part<decltype(selector)>(a, selector % kParts<decltype(selector)>);
  });
}
/// Like execute_pv_shuffle() for two words. A selector is the number of a part: first the parts of `low`, then those of
/// `high`.
template <Op kOp>
constexpr Word execute_pv_shuffle2(Word low, Word high, Word selectors) {
  return on_parts<Unsigned<kOp>>(selectors, 0, [low, high](auto selector, auto) {
    using T = decltype(selector);
    return part<T>((selector & kParts<T>) != 0 ? high : low, selector % kParts<T>);
  });
}
/// Returns the low halves of two words: that of `a` as the upper half, and that of `b` as the lower half.
constexpr Word execute_pv_pack_h(Word a, Word b) {
  return a << 16 | (b & 0xffffU);
}
/// Returns the high halves of two words: that of `a` as the upper half, and that of `b` as the lower half.
constexpr Word execute_pv_pack_h_h(Word a, Word b) {
  return (a & 0xffff0000U) | b >> 16;
}
/// Return `into` with one half replaced by the low bytes of two words: the upper half (packhi) or the lower half
/// (packlo).
constexpr Word execute_pv_packhi_b(Word into, Word a, Word b) {
  return (into & 0x0000ffffU) | (a & 0xffU) << 24 | (b & 0xffU) << 16;
}
constexpr Word execute_pv_packlo_b(Word into, Word a, Word b) {
  return (into & 0xffff0000U) | (a & 0xffU) << 8 | (b & 0xffU);
}

#ifdef MEBOTS_TRANSLATES
struct Part {
  int position;
  std::uint32_t low;  // mask of a part at position 0
};
/// Returns the half or byte of a word whose number is the immediate.
Part part_of(const Instruction* at) {
  const auto bits = on_bytes(at->op) ? 8U : 16U;
  return {static_cast<int>((static_cast<unsigned>(at->imm) % (32 / bits)) * bits), (1U << bits) - 1U};
}
void emit_pv_extract(Assembler& c, const Instruction* at) {
  c.registers.copy(eax, at->rs1);
  c.shr(eax, part_of(at).position);
  const Xbyak::Reg& low = on_bytes(at->op) ? static_cast<const Xbyak::Reg&>(al) : ax;
  traits_of(at->op).sign ? c.movsx(eax, low) : c.movzx(eax, low);
  c.registers.finish(at->rd, eax);
}
void emit_pv_extractu(Assembler& c, const Instruction* at) {
  emit_pv_extract(c, at);
}
void emit_pv_insert(Assembler& c, const Instruction* at) {
  const auto part = part_of(at);
  c.registers.copy(eax, at->rs1);
  c.and_(eax, part.low);
  c.shl(eax, part.position);
  c.registers.copy(ecx, at->rd);
  c.and_(ecx, ~(part.low << part.position));
  c.or_(eax, ecx);
  c.registers.finish(at->rd, eax);
}
void emit_pv_shuffle(Assembler& c, const Instruction* at) {
  const bool bytes = on_bytes(at->op);
  const bool two = reads_rd(at->op);
  c.registers.copy(eax, at->rs1);
  if (operand_of(*at) == Operand::immediate) {
    c.mov(ecx, static_cast<std::uint32_t>(at->imm));
  } else {
    c.registers.copy(ecx, at->rs2);
  }
  if (two) {  // rd in the lower bytes, rs1 in the upper bytes
    c.registers.copy(edx, at->rd);
    c.shl(rax, 32);
    c.or_(rax, rdx);
  }
  c.movq(xmm0, rax);
  const auto selects = (bytes ? 3U : 1U) << (two ? 1 : 0) | 1U;
  c.and_(ecx, selects * (bytes ? 0x01010101U : 0x00010001U));
  if (!bytes) {  // half n consists of the bytes 2 n and 2 n + 1
    c.imul(ecx, ecx, 0x0202);
    c.add(ecx, 0x01000100);
  }
  c.movd(xmm1, ecx);
  c.pshufb(xmm0, xmm1);
  c.movd(eax, xmm0);
  c.registers.finish(at->rd, eax);
}
void emit_pv_shuffle2(Assembler& c, const Instruction* at) {
  emit_pv_shuffle(c, at);
}
void emit_pack_halves(Assembler& c, const Instruction* at, bool of_high) {
  c.registers.copy(eax, at->rs1);
  c.registers.copy(ecx, at->rs2);
  if (of_high) {
    c.and_(eax, 0xffff0000U);
    c.shr(ecx, 16);
  } else {
    c.shl(eax, 16);
    c.movzx(ecx, cx);
  }
  c.or_(eax, ecx);
  c.registers.finish(at->rd, eax);
}
void emit_pv_pack_h(Assembler& c, const Instruction* at) {
  emit_pack_halves(c, at, false);
}
void emit_pv_pack_h_h(Assembler& c, const Instruction* at) {
  emit_pack_halves(c, at, true);
}
void emit_pack_bytes(Assembler& c, const Instruction* at, bool into_high) {
  c.registers.copy(eax, at->rs1);
  c.movzx(eax, al);
  c.shl(eax, 8);
  c.registers.copy(ecx, at->rs2);
  c.movzx(ecx, cl);
  c.or_(eax, ecx);
  if (into_high) c.shl(eax, 16);
  c.registers.copy(ecx, at->rd);
  c.and_(ecx, into_high ? 0x0000ffffU : 0xffff0000U);
  c.or_(eax, ecx);
  c.registers.finish(at->rd, eax);
}
void emit_pv_packhi_b(Assembler& c, const Instruction* at) {
  emit_pack_bytes(c, at, true);
}
void emit_pv_packlo_b(Assembler& c, const Instruction* at) {
  emit_pack_bytes(c, at, false);
}
#endif

}  // namespace

constinit const Operation kOperations[] = {
#include "fmu_soc_isa/xpulp_simd.inc"
};

}  // namespace mebots::soc::xpulp_simd
