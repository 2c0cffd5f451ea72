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
  const Cpu& cpu = host_processor();
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

/// One host instruction on halves or bytes.
void Emitter::emit_packed(const Instruction* at, host::Packed apply) {
  copy(eax, at->rs1);
  load_second(at);
  movd(xmm0, eax);
  movd(xmm1, ecx);
  apply(*this, xmm0, xmm1);
  movd(eax, xmm0);
  finish(at->rd, eax);
}

void Emitter::emit_packed_unary(const Instruction* at, host::Packed apply) {
  copy(eax, at->rs1);
  movd(xmm0, eax);
  apply(*this, xmm0, xmm0);
  movd(eax, xmm0);
  finish(at->rd, eax);
}

/// Half of the sum in each part, which wraps.
void Emitter::emit_average(const Instruction* at, bool sign) {
  copy(eax, at->rs1);
  load_second(at);
  movd(xmm0, eax);
  movd(xmm1, ecx);
  if (on_bytes(at->op)) {
    paddb(xmm0, xmm1);
    punpcklbw(xmm0, xmm0);  // each byte in the upper half of a word
    sign ? psraw(xmm0, 9) : psrlw(xmm0, 9);
    sign ? packsswb(xmm0, xmm0) : packuswb(xmm0, xmm0);
  } else {
    paddw(xmm0, xmm1);
    sign ? psraw(xmm0, 1) : psrlw(xmm0, 1);
  }
  movd(eax, xmm0);
  finish(at->rd, eax);
}

/// Of all bits alike.
void Emitter::emit_logic(const Instruction* at, host::Binary apply) {
  copy(eax, at->rs1);
  load_second(at);
  apply(*this, eax, ecx);
  finish(at->rd, eax);
}

/// a == b, !=; a > b, >=, <, <= signed; the same unsigned: with turned signs.
void Emitter::emit_compare_parts(const Instruction* at) {
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
bool Emitter::emit_shift_parts(const Instruction* at, PartShift shift) {
  const bool bytes = on_bytes(at->op);
  const auto from = operand_of(*at);
  if (from == Operand::reg || (from == Operand::scalar && bytes)) return false;
  copy(eax, at->rs1);
  if (from == Operand::scalar) {
    copy(ecx, at->rs2);
    and_(ecx, 15);
    movd(xmm0, eax);
    movd(xmm1, ecx);
    if (shift == PartShift::right) psrlw(xmm0, xmm1);
    if (shift == PartShift::right_signed) psraw(xmm0, xmm1);
    if (shift == PartShift::left) psllw(xmm0, xmm1);
    movd(eax, xmm0);
    finish(at->rd, eax);
    return true;
  }
  const auto places = static_cast<int>(static_cast<unsigned>(at->imm) & (bytes ? 7U : 15U));
  const auto in_all = [bytes](std::uint32_t part) {
    return bytes ? (part & 0xffU) * 0x01010101U : (part & 0xffffU) * 0x00010001U;
  };
  if (shift == PartShift::right) {
    shr(eax, places);
    and_(eax, in_all((bytes ? 0xffU : 0xffffU) >> places));
  } else if (shift == PartShift::left) {
    shl(eax, places);
    and_(eax, in_all((bytes ? 0xffU : 0xffffU) << places));
  } else {
    movd(xmm0, eax);
    if (bytes) {
      punpcklbw(xmm0, xmm0);
      psraw(xmm0, 8 + places);
      packsswb(xmm0, xmm0);
    } else {
      psraw(xmm0, places);
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

/// The part that the immediate names.
Emitter::Part Emitter::part_of(const Instruction* at) {
  const auto bits = on_bytes(at->op) ? 8U : 16U;
  return {static_cast<int>((static_cast<unsigned>(at->imm) % (32 / bits)) * bits), (1U << bits) - 1U};
}

void Emitter::emit_extract_part(const Instruction* at) {
  copy(eax, at->rs1);
  shr(eax, part_of(at).position);
  const Xbyak::Reg& low = on_bytes(at->op) ? static_cast<const Xbyak::Reg&>(al) : ax;
  traits_of(at->op).sign ? movsx(eax, low) : movzx(eax, low);
  finish(at->rd, eax);
}

void Emitter::emit_insert_part(const Instruction* at) {
  const auto part = part_of(at);
  copy(eax, at->rs1);
  and_(eax, part.low);
  shl(eax, part.position);
  copy(ecx, at->rd);
  and_(ecx, ~(part.low << part.position));
  or_(eax, ecx);
  finish(at->rd, eax);
}

/// Of the parts of one register, or of two.
void Emitter::emit_shuffle(const Instruction* at) {
  const bool bytes = on_bytes(at->op);
  const bool two = reads_rd(at->op);
  copy(eax, at->rs1);
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
  finish(at->rd, eax);
}

void Emitter::emit_pack_halves(const Instruction* at, bool of_high) {
  copy(eax, at->rs1);
  copy(ecx, at->rs2);
  if (of_high) {
    and_(eax, 0xffff0000U);
    shr(ecx, 16);
  } else {
    shl(eax, 16);
    movzx(ecx, cx);
  }
  or_(eax, ecx);
  finish(at->rd, eax);
}

/// Two bytes into the upper or the lower half of rd.
void Emitter::emit_pack_bytes(const Instruction* at, bool into_high) {
  copy(eax, at->rs1);
  movzx(eax, al);
  shl(eax, 8);
  copy(ecx, at->rs2);
  movzx(ecx, cl);
  or_(eax, ecx);
  if (into_high) shl(eax, 16);
  copy(ecx, at->rd);
  and_(ecx, into_high ? 0x0000ffffU : 0xffff0000U);
  or_(eax, ecx);
  finish(at->rd, eax);
}

}  // namespace mebots::soc::translate
