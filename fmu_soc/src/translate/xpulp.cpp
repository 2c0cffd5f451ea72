// SPDX-License-Identifier: Apache-2.0
//
// The scalar computing of Xpulp v2. Meanings: isa/operations_xpulp.hpp.
#include "translate/emitter.hpp"

namespace mebots::soc::translate {

void Emitter::emit_absolute(const Instruction* at) {
  copy(eax, at->rs1);
  mov(ecx, eax);
  neg(eax);
  cmovs(eax, ecx);
  finish(at->rd, eax);
}

void Emitter::emit_unary(const Instruction* at, host::Binary apply) {
  copy(eax, at->rs1);
  apply(*this, eax, eax);
  finish(at->rd, eax);
}

/// The second operand where the flags of first - second say so.
void Emitter::emit_select(const Instruction* at, host::Binary move) {
  copy(eax, at->rs1);
  copy(ecx, at->rs2);
  cmp(eax, ecx);
  move(*this, eax, ecx);
  finish(at->rd, eax);
}

void Emitter::emit_extend(const Instruction* at, bool sign, unsigned bits) {
  copy(eax, at->rs1);
  const Xbyak::Reg& low = bits == 16 ? static_cast<const Xbyak::Reg&>(ax) : al;
  sign ? movsx(eax, low) : movzx(eax, low);
  finish(at->rd, eax);
}

/// Number of the highest bit that is set; 32 for 0.
void Emitter::emit_find_last(const Instruction* at) {
  copy(eax, at->rs1);
  lzcnt(eax, eax);  // 32 for 0: stays
  mov(ecx, 31);
  sub(ecx, eax);
  cmovns(eax, ecx);
  finish(at->rd, eax);
}

void Emitter::emit_rotate(const Instruction* at) {
  copy(eax, at->rs1);
  copy(ecx, at->rs2);
  ror(eax, cl);
  finish(at->rd, eax);
}

/// p.mac and p.msu.
void Emitter::emit_multiply_accumulate(const Instruction* at, bool subtracts) {
  copy(eax, at->rs1);
  copy(ecx, at->rs2);
  imul(eax, ecx);
  if (in_vector(at->rd)) {
    movd(xmm0, eax);
    subtracts ? psubd(vector(at->rd), xmm0) : paddd(vector(at->rd), xmm0);
  } else if (subtracts) {
    sub(operand(at->rd), eax);
  } else {
    add(operand(at->rd), eax);
  }
}

/// Between 0, or the bound's complement where signed, and the bound.
void Emitter::emit_clip(const Instruction* at, bool is_signed) {
  copy(eax, at->rs1);
  if (operand_of(*at) == Operand::immediate) {
    mov(ecx, static_cast<std::uint32_t>(at->imm));
  } else {
    copy(ecx, at->rs2);
  }
  if (is_signed) {
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
  finish(at->rd, edx);
}

/// The field of a word that an immediate says; none where registers do, which is rare. What passes the end of the word
/// is not part of it.
std::optional<Emitter::Field> Emitter::field_of(const Instruction* at) {
  if (operand_of(*at) != Operand::immediate) return std::nullopt;
  const auto imm = static_cast<unsigned>(at->imm);
  Field field{.position = imm & 31U, .width = (imm >> 5 & 31U) + 1};
  field.low = field.width == 32 ? ~0U : (1U << field.width) - 1U;
  field.mask = field.low << field.position;
  return field;
}

bool Emitter::emit_extract_field(const Instruction* at, bool sign) {
  const auto field = field_of(at);
  if (!field) return false;
  copy(eax, at->rs1);
  if (sign) {
    const auto unused = static_cast<int>(32 - field->width);
    sar(eax, static_cast<int>(field->position));
    shl(eax, unused);
    sar(eax, unused);
  } else {
    shr(eax, static_cast<int>(field->position));
    and_(eax, field->low);
  }
  finish(at->rd, eax);
  return true;
}

bool Emitter::emit_insert_field(const Instruction* at) {
  const auto field = field_of(at);
  if (!field) return false;
  copy(eax, at->rs1);
  shl(eax, static_cast<int>(field->position));
  and_(eax, field->mask);
  copy(ecx, at->rd);
  and_(ecx, ~field->mask);
  or_(eax, ecx);
  finish(at->rd, eax);
  return true;
}

bool Emitter::emit_clear_field(const Instruction* at) {
  const auto field = field_of(at);
  if (!field) return false;
  copy(eax, at->rs1);
  and_(eax, ~field->mask);
  finish(at->rd, eax);
  return true;
}

bool Emitter::emit_set_field(const Instruction* at) {
  const auto field = field_of(at);
  if (!field) return false;
  copy(eax, at->rs1);
  or_(eax, field->mask);
  finish(at->rd, eax);
  return true;
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
  if (traits.reads_rd) add(eax, source(at->rd, ecx));
  if (traits.rounds) add(eax, (1U << shift) >> 1);
  traits.sign ? sar(eax, static_cast<int>(shift)) : shr(eax, static_cast<int>(shift));
  finish(at->rd, eax);
}

}  // namespace mebots::soc::translate
