// SPDX-License-Identifier: Apache-2.0
//
// The scalar computing of Xpulp v2. Meanings: isa/operations_xpulp.hpp.
#include "translate/emitter.hpp"

namespace mebots::soc::translate {

/// False: not one of these, or a rare one that the interpreter does.
bool Emitter::emit_xpulp(const Instruction* at) {
  if (is_simd(at->op)) return emit_simd(at);
  if (traits_of(at->op).kind == OpKind::shifted_sum) {
    emit_shifted_sum(at);
    return true;
  }
  if (traits_of(at->op).kind == OpKind::multiply_halves) {
    emit_multiply_halves(at);
    return true;
  }
  const auto imm = static_cast<std::uint32_t>(at->imm);
  switch (at->op) {
    case Op::p_abs:
      copy(eax, at->rs1);
      mov(ecx, eax);
      neg(eax);
      cmovs(eax, ecx);
      break;
    case Op::p_slet:
    case Op::p_sletu:
      emit_compare(at->rs1, at->rs2);
      at->op == Op::p_slet ? setle(al) : setbe(al);
      movzx(eax, al);
      break;
    case Op::p_min:
    case Op::p_minu:
    case Op::p_max:
    case Op::p_maxu:
      copy(eax, at->rs1);
      copy(ecx, at->rs2);
      cmp(eax, ecx);
      if (at->op == Op::p_min) cmovg(eax, ecx);
      if (at->op == Op::p_minu) cmova(eax, ecx);
      if (at->op == Op::p_max) cmovl(eax, ecx);
      if (at->op == Op::p_maxu) cmovb(eax, ecx);
      break;
    case Op::p_exths:
      copy(eax, at->rs1);
      movsx(eax, ax);
      break;
    case Op::p_exthz:
      copy(eax, at->rs1);
      movzx(eax, ax);
      break;
    case Op::p_extbs:
      copy(eax, at->rs1);
      movsx(eax, al);
      break;
    case Op::p_extbz:
      copy(eax, at->rs1);
      movzx(eax, al);
      break;
    case Op::p_clip:
    case Op::p_clipu:
      emit_clip(at);
      break;
    case Op::p_extract:
    case Op::p_extractu:
    case Op::p_insert:
    case Op::p_bclr:
    case Op::p_bset:
      if (operand_of(*at) != Operand::immediate) return false;
      emit_bit_field(at, imm & 31U, (imm >> 5 & 31U) + 1);
      break;
    case Op::p_ff1:
      copy(eax, at->rs1);
      tzcnt(eax, eax);
      break;
    case Op::p_cnt:
      copy(eax, at->rs1);
      popcnt(eax, eax);
      break;
    case Op::p_fl1:
      copy(eax, at->rs1);
      lzcnt(eax, eax);  // 32 for 0: stays
      mov(ecx, 31);
      sub(ecx, eax);
      cmovns(eax, ecx);
      break;
    case Op::p_ror:
      copy(eax, at->rs1);
      copy(ecx, at->rs2);
      ror(eax, cl);
      break;
    case Op::p_mac:
    case Op::p_msu:
      copy(eax, at->rs1);
      copy(ecx, at->rs2);
      imul(eax, ecx);
      if (at->op == Op::p_mac) {
        add(operand(at->rd), eax);
      } else {
        sub(operand(at->rd), eax);
      }
      return true;
    default:
      return false;
  }
  finish(at->rd, eax);
  return true;
}

void Emitter::emit_clip(const Instruction* at) {
  copy(eax, at->rs1);
  if (operand_of(*at) == Operand::immediate) {
    mov(ecx, static_cast<std::uint32_t>(at->imm));
  } else {
    copy(ecx, at->rs2);
  }
  if (at->op == Op::p_clip) {
    mov(edx, ecx);
    not_(edx);
    cmp(eax, edx);
    cmovge(edx, eax);
  } else {
    xor_(edx, edx);
    test(eax, eax);
    cmovns(edx, eax);
  }
  cmp(eax, ecx);  // comes first where the two bounds cross
  cmovg(edx, ecx);
  mov(eax, edx);
}

/// A field of `width` bits from `position` on; what passes the end of the word is not part of it.
void Emitter::emit_bit_field(const Instruction* at, unsigned position, unsigned width) {
  const auto low = width == 32 ? ~0U : (1U << width) - 1U;
  const auto mask = low << position;
  copy(eax, at->rs1);
  switch (at->op) {
    case Op::p_extractu:
      shr(eax, static_cast<int>(position));
      and_(eax, low);
      break;
    case Op::p_extract:
      sar(eax, static_cast<int>(position));
      shl(eax, static_cast<int>(32 - width));
      sar(eax, static_cast<int>(32 - width));
      break;
    case Op::p_insert:
      shl(eax, static_cast<int>(position));
      and_(eax, mask);
      copy(ecx, at->rd);
      and_(ecx, ~mask);
      or_(eax, ecx);
      break;
    case Op::p_bclr:
      and_(eax, ~mask);
      break;
    default:
      or_(eax, mask);
      break;
  }
}

/// p.addN and its kin.
void Emitter::emit_shifted_sum(const Instruction* at) {
  const auto& traits = traits_of(at->op);
  const bool by_register = traits.reads_rd;
  const auto shift = static_cast<unsigned>(at->imm) & 31U;
  copy(eax, by_register ? at->rd : at->rs1);
  copy(ecx, by_register ? at->rs1 : at->rs2);
  if (traits.subtracts) {
    sub(eax, ecx);
  } else {
    add(eax, ecx);
  }
  if (!by_register) {
    if (traits.rounds) add(eax, (1U << shift) >> 1);
    traits.sign ? sar(eax, static_cast<int>(shift)) : shr(eax, static_cast<int>(shift));
  } else {
    copy(ecx, at->rs2);
    if (traits.rounds) {
      mov(edx, 1);
      shlx(edx, edx, ecx);
      shr(edx, 1);
      add(eax, edx);
    }
    traits.sign ? sarx(eax, eax, ecx) : shrx(eax, eax, ecx);
  }
  finish(at->rd, eax);
}

/// p.mulsN and its kin.
void Emitter::emit_multiply_halves(const Instruction* at) {
  const auto& traits = traits_of(at->op);
  const auto shift = static_cast<unsigned>(at->imm) & 31U;
  const auto take_half = [&](const Reg32& to, unsigned reg) {
    copy(to, reg);
    if (traits.high) {
      traits.sign ? sar(to, 16) : shr(to, 16);
    } else {
      traits.sign ? movsx(to, to.cvt16()) : movzx(to, to.cvt16());
    }
  };
  take_half(eax, at->rs1);
  take_half(ecx, at->rs2);
  imul(eax, ecx);
  if (traits.reads_rd) add(eax, operand(at->rd));
  if (traits.rounds) add(eax, (1U << shift) >> 1);
  traits.sign ? sar(eax, static_cast<int>(shift)) : shr(eax, static_cast<int>(shift));
  finish(at->rd, eax);
}

}  // namespace mebots::soc::translate
