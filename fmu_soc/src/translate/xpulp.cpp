// SPDX-License-Identifier: Apache-2.0
//
// The scalar computing of Xpulp v2. Meanings: isa/operations_xpulp.hpp.
#include "translate/emitter.hpp"

namespace mebots::soc::translate {

/// False: not one of these, or a rare one that the interpreter does.
bool Emitter::emit_xpulp(const Instruction* at) {
  if (is_simd(at->op)) return emit_simd(at);
  if (at->op >= Op::p_addN && at->op <= Op::p_subuRNr) {
    emit_shifted_sum(at);
    return true;
  }
  if (at->op >= Op::p_mulsN && at->op <= Op::p_machhuRN) {
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

/// p.addN and its kin: eight with an immediate shift, eight with a register; of each four that add, four that
/// subtract; signed, unsigned, signed and rounded, unsigned and rounded.
void Emitter::emit_shifted_sum(const Instruction* at) {
  const auto kind = static_cast<unsigned>(at->op) - static_cast<unsigned>(Op::p_addN);
  const bool by_register = kind >= 8;
  const bool subtracts = (kind & 4U) != 0;
  const bool rounds = (kind & 2U) != 0;
  const bool is_unsigned = (kind & 1U) != 0;
  const auto shift = static_cast<unsigned>(at->imm) & 31U;
  copy(eax, by_register ? at->rd : at->rs1);
  copy(ecx, by_register ? at->rs1 : at->rs2);
  if (subtracts) {
    sub(eax, ecx);
  } else {
    add(eax, ecx);
  }
  if (!by_register) {
    if (rounds) add(eax, (1U << shift) >> 1);
    is_unsigned ? shr(eax, static_cast<int>(shift)) : sar(eax, static_cast<int>(shift));
  } else {
    copy(ecx, at->rs2);
    if (rounds) {
      mov(edx, 1);
      shlx(edx, edx, ecx);
      shr(edx, 1);
      add(eax, edx);
    }
    is_unsigned ? shrx(eax, eax, ecx) : sarx(eax, eax, ecx);
  }
  finish(at->rd, eax);
}

/// p.mulsN and its kin: eight that multiply, eight that add to rd; of each four signed, four unsigned; low halves, high
/// halves, low and rounded, high and rounded.
void Emitter::emit_multiply_halves(const Instruction* at) {
  const auto kind = static_cast<unsigned>(at->op) - static_cast<unsigned>(Op::p_mulsN);
  const bool accumulates = kind >= 8;
  const bool is_unsigned = (kind & 4U) != 0;
  const bool rounds = (kind & 2U) != 0;
  const bool high = (kind & 1U) != 0;
  const auto shift = static_cast<unsigned>(at->imm) & 31U;
  const auto take_half = [&](const Reg32& to, unsigned reg) {
    copy(to, reg);
    if (high) {
      is_unsigned ? shr(to, 16) : sar(to, 16);
    } else {
      is_unsigned ? movzx(to, to.cvt16()) : movsx(to, to.cvt16());
    }
  };
  take_half(eax, at->rs1);
  take_half(ecx, at->rs2);
  imul(eax, ecx);
  if (accumulates) add(eax, operand(at->rd));
  if (rounds) add(eax, (1U << shift) >> 1);
  is_unsigned ? shr(eax, static_cast<int>(shift)) : sar(eax, static_cast<int>(shift));
  finish(at->rd, eax);
}

}  // namespace mebots::soc::translate
