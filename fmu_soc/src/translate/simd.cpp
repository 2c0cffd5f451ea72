// SPDX-License-Identifier: Apache-2.0
//
// The SIMD computing of Xpulp v2, in the low 32 bits of SSE registers. Meanings: isa/operations_simd.hpp.
#include "translate/emitter.hpp"

#include <xbyak/xbyak_util.h>

#include <optional>

namespace mebots::soc::translate {
namespace {

bool on_bytes(Op op) {
  return traits_of(op).parts == 4;
}
/// How the host does a dot product of unsigned by signed bytes in one instruction, if it can.
std::optional<Xbyak::PreferredEncoding> host_dot_product() {
  using Xbyak::util::Cpu;
  static const Cpu cpu;
  if (cpu.has(Cpu::tAVX_VNNI)) return Xbyak::VexEncoding;
  if (cpu.has(Cpu::tAVX512_VNNI) && cpu.has(Cpu::tAVX512VL)) return Xbyak::EvexEncoding;
  return std::nullopt;
}

constexpr std::uint32_t kSignOfBytes = 0x80808080U;
constexpr std::uint32_t kSignOfHalves = 0x80008000U;

}  // namespace

/// The second operand, from where the instruction has it, in ecx.
void Emitter::load_second(const Instruction* at) {
  const auto from = operand_of(*at);
  if (from == Operand::immediate) {
    mov(ecx, static_cast<std::uint32_t>(at->imm));
    return;
  }
  copy(ecx, at->rs2);
  if (from != Operand::scalar) return;
  if (on_bytes(at->op)) {
    movzx(ecx, cl);
    imul(ecx, ecx, 0x01010101);
  } else {
    movzx(ecx, cx);
    imul(ecx, ecx, 0x00010001);
  }
}

/// False: one of the rare ones that the interpreter does.
bool Emitter::emit_simd(const Instruction* at) {
  switch (traits_of(at->op).kind) {
    case OpKind::dot_product:
      emit_dot(at);
      return true;
    case OpKind::simd_compare:
      emit_simd_compare(at);
      return true;
    case OpKind::simd_shift:
      return emit_simd_shift(at);
    case OpKind::simd_parts:
      emit_parts(at);
      return true;
    default:
      break;
  }
  copy(eax, at->rs1);
  if (at->op == Op::pv_abs_h || at->op == Op::pv_abs_b) {
    movd(xmm0, eax);
    at->op == Op::pv_abs_h ? pabsw(xmm0, xmm0) : pabsb(xmm0, xmm0);
    movd(eax, xmm0);
    finish(at->rd, eax);
    return true;
  }
  load_second(at);
  if (emit_simd_logic(at)) return true;
  movd(xmm0, eax);
  movd(xmm1, ecx);
  switch (at->op) {
    case Op::pv_add_h:
      paddw(xmm0, xmm1);
      break;
    case Op::pv_add_b:
      paddb(xmm0, xmm1);
      break;
    case Op::pv_sub_h:
      psubw(xmm0, xmm1);
      break;
    case Op::pv_sub_b:
      psubb(xmm0, xmm1);
      break;
    case Op::pv_avg_h:
      paddw(xmm0, xmm1);
      psraw(xmm0, 1);
      break;
    case Op::pv_avgu_h:
      paddw(xmm0, xmm1);
      psrlw(xmm0, 1);
      break;
    case Op::pv_avg_b:
      paddb(xmm0, xmm1);
      punpcklbw(xmm0, xmm0);  // each byte in the upper half of a word
      psraw(xmm0, 9);
      packsswb(xmm0, xmm0);
      break;
    case Op::pv_avgu_b:
      paddb(xmm0, xmm1);
      punpcklbw(xmm0, xmm0);
      psrlw(xmm0, 9);
      packuswb(xmm0, xmm0);
      break;
    case Op::pv_min_h:
      pminsw(xmm0, xmm1);
      break;
    case Op::pv_min_b:
      pminsb(xmm0, xmm1);
      break;
    case Op::pv_minu_h:
      pminuw(xmm0, xmm1);
      break;
    case Op::pv_minu_b:
      pminub(xmm0, xmm1);
      break;
    case Op::pv_max_h:
      pmaxsw(xmm0, xmm1);
      break;
    case Op::pv_max_b:
      pmaxsb(xmm0, xmm1);
      break;
    case Op::pv_maxu_h:
      pmaxuw(xmm0, xmm1);
      break;
    default:  // pv.maxu.b
      pmaxub(xmm0, xmm1);
      break;
  }
  movd(eax, xmm0);
  finish(at->rd, eax);
  return true;
}

/// Of all bits alike. False: another operation.
bool Emitter::emit_simd_logic(const Instruction* at) {
  switch (at->op) {
    case Op::pv_or_h:
    case Op::pv_or_b:
      or_(eax, ecx);
      break;
    case Op::pv_xor_h:
    case Op::pv_xor_b:
      xor_(eax, ecx);
      break;
    case Op::pv_and_h:
    case Op::pv_and_b:
      and_(eax, ecx);
      break;
    default:
      return false;
  }
  finish(at->rd, eax);
  return true;
}

/// a == b, !=; a > b, >=, <, <= signed; the same unsigned: with turned signs.
void Emitter::emit_simd_compare(const Instruction* at) {
  const bool bytes = on_bytes(at->op);
  copy(eax, at->rs1);
  load_second(at);
  const auto relation = traits_of(at->op).relation;
  if (!traits_of(at->op).sign) {
    const auto sign = bytes ? kSignOfBytes : kSignOfHalves;
    xor_(eax, sign);
    xor_(ecx, sign);
  }
  movd(xmm0, eax);
  movd(xmm1, ecx);
  const bool equal = relation == Relation::eq || relation == Relation::ne;
  const bool swapped = relation == Relation::ge || relation == Relation::lt;
  const bool inverted = relation == Relation::ne || relation == Relation::ge || relation == Relation::le;
  const auto& left = swapped ? xmm1 : xmm0;
  const auto& right = swapped ? xmm0 : xmm1;
  if (equal) {
    bytes ? pcmpeqb(left, right) : pcmpeqw(left, right);
  } else {
    bytes ? pcmpgtb(left, right) : pcmpgtw(left, right);
  }
  movd(eax, left);
  if (inverted) not_(eax);
  finish(at->rd, eax);
}

/// By the same number of places in all parts; other shifts are rare.
bool Emitter::emit_simd_shift(const Instruction* at) {
  const bool bytes = on_bytes(at->op);
  const auto from = operand_of(*at);
  if (from == Operand::reg || (from == Operand::scalar && bytes)) return false;
  copy(eax, at->rs1);
  if (from == Operand::scalar) {
    copy(ecx, at->rs2);
    and_(ecx, 15);
    movd(xmm0, eax);
    movd(xmm1, ecx);
    if (at->op == Op::pv_srl_h) psrlw(xmm0, xmm1);
    if (at->op == Op::pv_sra_h) psraw(xmm0, xmm1);
    if (at->op == Op::pv_sll_h) psllw(xmm0, xmm1);
    movd(eax, xmm0);
    finish(at->rd, eax);
    return true;
  }
  const auto shift = static_cast<int>(static_cast<unsigned>(at->imm) & (bytes ? 7U : 15U));
  const auto in_all = [bytes](std::uint32_t part) {
    return bytes ? (part & 0xffU) * 0x01010101U : (part & 0xffffU) * 0x00010001U;
  };
  if (at->op == Op::pv_srl_h || at->op == Op::pv_srl_b) {
    shr(eax, shift);
    and_(eax, in_all((bytes ? 0xffU : 0xffffU) >> shift));
  } else if (at->op == Op::pv_sll_h || at->op == Op::pv_sll_b) {
    shl(eax, shift);
    and_(eax, in_all((bytes ? 0xffU : 0xffffU) << shift));
  } else {
    movd(xmm0, eax);
    if (bytes) {
      punpcklbw(xmm0, xmm0);
      psraw(xmm0, 8 + shift);
      packsswb(xmm0, xmm0);
    } else {
      psraw(xmm0, shift);
    }
    movd(eax, xmm0);
  }
  finish(at->rd, eax);
  return true;
}

/// Products of halves by pmaddwd where both are signed, else one by one. Bytes are widened to halves first, since
/// pmaddubsw would saturate, but for unsigned by signed ones, for which newer hosts have an instruction.
void Emitter::emit_dot(const Instruction* at) {
  const bool accumulates = reads_rd(at->op);
  const bool left_signed = traits_of(at->op).sign;
  const bool right_signed = traits_of(at->op).second_sign;
  if (on_bytes(at->op)) {
    const auto left = in_vector_for(at->rs1, xmm0);
    auto right = xmm1;
    if (operand_of(*at) == Operand::reg) {
      right = in_vector_for(at->rs2, xmm1);
    } else {
      load_second(at);
      movd(xmm1, ecx);
    }
    if (const auto encoding = host_dot_product(); encoding && !left_signed && right_signed) {
      const auto sum = accumulates ? in_vector_for(at->rd, xmm2) : xmm2;
      if (!accumulates) pxor(sum, sum);
      vpdpbusd(sum, left, right, *encoding);
      finish_vector(at->rd, sum);
      return;
    }
    left_signed ? pmovsxbw(xmm0, left) : pmovzxbw(xmm0, left);
    right_signed ? pmovsxbw(xmm1, right) : pmovzxbw(xmm1, right);
    pmaddwd(xmm0, xmm1);
    pshufd(xmm1, xmm0, 1);
    paddd(xmm0, xmm1);
    finish_sum(at->rd, accumulates, xmm0);
    return;
  }
  if (left_signed) {
    load_second(at);
    movd(xmm1, ecx);
    if (in_vector(at->rs1)) {
      movdqa(xmm0, vector(at->rs1));
    } else {
      copy(eax, at->rs1);
      movd(xmm0, eax);
    }
    pmaddwd(xmm0, xmm1);
    finish_sum(at->rd, accumulates, xmm0);
  } else {
    copy(eax, at->rs1);
    load_second(at);
    mov(edx, eax);
    movzx(eax, ax);
    shr(edx, 16);
    push(rsi);
    mov(esi, ecx);
    right_signed ? movsx(ecx, cx) : movzx(ecx, cx);
    imul(eax, ecx);
    right_signed ? sar(esi, 16) : shr(esi, 16);
    imul(edx, esi);
    pop(rsi);
    add(eax, edx);
    movd(xmm0, eax);
    finish_sum(at->rd, accumulates, xmm0);
  }
}

/// A register's value in a vector register, which must not be changed unless it is `scratch`.
Xbyak::Xmm Emitter::in_vector_for(unsigned reg, const Xbyak::Xmm& scratch) {
  if (in_vector(reg)) return vector(reg);
  if (reg == 0) {
    pxor(scratch, scratch);
  } else if (in_host(reg)) {
    movd(scratch, host(reg));
  } else {
    movd(scratch, memory(reg));
  }
  return scratch;
}

/// A result in the low word of a vector register.
void Emitter::finish_vector(unsigned rd, const Xbyak::Xmm& result) {
  if (in_vector(rd)) {
    if (vector(rd).getIdx() != result.getIdx()) movdqa(vector(rd), result);
  } else if (in_host(rd)) {
    movd(host(rd), result);
  } else {
    movd(memory(rd), result);
  }
}

/// Likewise, or what must be added to the register; eax may be lost.
void Emitter::finish_sum(unsigned rd, bool accumulates, const Xbyak::Xmm& sum) {
  if (!accumulates) {
    finish_vector(rd, sum);
  } else if (in_vector(rd)) {
    paddd(vector(rd), sum);
  } else {
    movd(eax, sum);
    add(operand(rd), eax);
  }
}

/// Extract, insert, shuffle and pack.
void Emitter::emit_parts(const Instruction* at) {
  const bool bytes = on_bytes(at->op);
  const auto bits = bytes ? 8U : 16U;
  const auto place = static_cast<int>((static_cast<unsigned>(at->imm) % (32 / bits)) * bits);
  const auto low = bytes ? 0xffU : 0xffffU;
  copy(eax, at->rs1);
  switch (at->op) {
    case Op::pv_extract_h:
    case Op::pv_extract_b:
    case Op::pv_extractu_h:
    case Op::pv_extractu_b: {
      const bool sign = traits_of(at->op).sign;
      shr(eax, place);
      if (bytes) {
        sign ? movsx(eax, al) : movzx(eax, al);
      } else {
        sign ? movsx(eax, ax) : movzx(eax, ax);
      }
      break;
    }
    case Op::pv_insert_h:
    case Op::pv_insert_b:
      and_(eax, low);
      shl(eax, place);
      copy(ecx, at->rd);
      and_(ecx, ~(low << place));
      or_(eax, ecx);
      break;
    case Op::pv_shuffle_h:
    case Op::pv_shuffle_b:
    case Op::pv_shuffle2_h:
    case Op::pv_shuffle2_b: {
      const bool two = reads_rd(at->op);
      if (operand_of(*at) == Operand::immediate) {
        mov(ecx, static_cast<std::uint32_t>(at->imm));
      } else {
        copy(ecx, at->rs2);
      }
      if (two) {  // rd below, rs1 above
        copy(edx, at->rd);
        shl(rax, 32);
        or_(rax, rdx);
      }
      movq(xmm0, rax);
      const auto selects = (bytes ? 3U : 1U) << (two ? 1 : 0) | 1U;
      and_(ecx, selects * (bytes ? 0x01010101U : 0x00010001U));
      if (!bytes) {  // half n is bytes 2 n and 2 n + 1
        imul(ecx, ecx, 0x0202);
        add(ecx, 0x01000100);
      }
      movd(xmm1, ecx);
      pshufb(xmm0, xmm1);
      movd(eax, xmm0);
      break;
    }
    case Op::pv_pack_h:
      shl(eax, 16);
      copy(ecx, at->rs2);
      movzx(ecx, cx);
      or_(eax, ecx);
      break;
    default: {  // pv.packhi.b, pv.packlo.b
      const bool high = at->op == Op::pv_packhi_b;
      movzx(eax, al);
      shl(eax, 8);
      copy(ecx, at->rs2);
      movzx(ecx, cl);
      or_(eax, ecx);
      if (high) shl(eax, 16);
      copy(ecx, at->rd);
      and_(ecx, high ? 0x0000ffffU : 0xffff0000U);
      or_(eax, ecx);
      break;
    }
  }
  finish(at->rd, eax);
}

}  // namespace mebots::soc::translate
