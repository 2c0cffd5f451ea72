// SPDX-License-Identifier: Apache-2.0
#include "translate/emitter.hpp"

namespace mebots::soc::translate {

/// lui, auipc
void Emitter::emit_constant(const Instruction* at) {
  set(at->rd, static_cast<std::uint32_t>(at->imm));
}

/// fence
void Emitter::emit_nothing(const Instruction* /*at*/) {}

void Emitter::emit_add_immediate(const Instruction* at) {
  if (at->rs1 == 0) {
    set(at->rd, static_cast<std::uint32_t>(at->imm));
  } else if (at->rd == at->rs1 && !in_vector(at->rd)) {
    if (at->imm != 0) add(operand(at->rd), static_cast<std::uint32_t>(at->imm));
  } else {
    const auto to = place(at->rd, eax);
    if (in_host(at->rs1) && at->imm != 0) {
      lea(to, ptr[host(at->rs1).cvt64() + at->imm]);
    } else {
      copy(to, at->rs1);
      if (at->imm != 0) add(to, static_cast<std::uint32_t>(at->imm));
    }
    finish(at->rd, to);
  }
}

void Emitter::emit_add(const Instruction* at) {
  const auto [a, b] = at->rd == at->rs2 ? std::pair{at->rs2, at->rs1} : std::pair{at->rs1, at->rs2};
  if (a == 0 || b == 0) {  // mv
    const auto to = place(at->rd, eax);
    copy(to, a == 0 ? b : a);
    finish(at->rd, to);
  } else if (at->rd == a && in_vector(a)) {
    paddd(vector(a), in_vector_for(b, xmm0));
  } else if (at->rd == a) {
    add(operand(a), value(b, eax));
  } else {
    const auto left = value(a, eax);
    const auto right = value(b, ecx);
    const auto to = place(at->rd, eax);
    lea(to, ptr[left.cvt64() + right.cvt64()]);
    finish(at->rd, to);
  }
}

void Emitter::emit_binary(const Instruction* at, host::Binary apply) {
  const auto to = place(at->rd, eax, at->rd == at->rs2 && at->rd != at->rs1);
  copy(to, at->rs1);
  if (at->rs2 == 0) {
    mov(ecx, 0);
    apply(*this, to, ecx);
  } else {
    apply(*this, to, source(at->rs2, ecx));
  }
  finish(at->rd, to);
}

void Emitter::emit_immediate(const Instruction* at, host::Immediate apply) {
  const auto to = place(at->rd, eax);
  copy(to, at->rs1);
  apply(*this, to, static_cast<std::uint32_t>(at->imm));
  finish(at->rd, to);
}

void Emitter::emit_shift_immediate(const Instruction* at, host::ShiftImmediate apply) {
  const auto to = place(at->rd, eax);
  copy(to, at->rs1);
  apply(*this, to, at->imm & 31);
  finish(at->rd, to);
}

void Emitter::emit_shift(const Instruction* at, host::Shift apply) {
  const auto to = place(at->rd, eax);
  const auto by = value(at->rs2, ecx);
  apply(*this, to, value(at->rs1, eax), by);
  finish(at->rd, to);
}

/// Flags of rs1 - rs2.
void Emitter::emit_compare(unsigned rs1, unsigned rs2) {
  if (rs1 != 0 && rs2 == 0) {
    if (in_host(rs1)) {
      test(host(rs1), host(rs1));
    } else {
      cmp(source(rs1, eax), 0);
    }
    return;
  }
  const auto left = value(rs1, eax);
  if (rs2 == 0) {
    cmp(left, 0);
  } else {
    cmp(left, source(rs2, ecx));
  }
}

/// 1 where the registers compare so, else 0.
void Emitter::emit_set(const Instruction* at, host::Set set_byte) {
  emit_compare(at->rs1, at->rs2);
  finish_set(at->rd, set_byte);
}

void Emitter::emit_set_immediate(const Instruction* at, host::Set set_byte) {
  if (at->rs1 == 0) {
    mov(eax, 0);
    cmp(eax, static_cast<std::uint32_t>(at->imm));
  } else {
    cmp(source(at->rs1, eax), static_cast<std::uint32_t>(at->imm));
  }
  finish_set(at->rd, set_byte);
}

void Emitter::finish_set(unsigned rd, host::Set set_byte) {
  set_byte(*this, al);
  const auto to = place(rd, eax);
  movzx(to, al);
  finish(rd, to);
}

void Emitter::emit_multiply_high(const Instruction* at, bool first_sign, bool second_sign) {
  const auto widen = [this](const Xbyak::Reg64& to, unsigned reg, bool sign) {
    if (sign && reg != 0) {
      movsxd(to, source(reg, to.cvt32()));
    } else {
      copy(to.cvt32(), reg);
    }
  };
  widen(rax, at->rs1, first_sign);
  widen(rcx, at->rs2, second_sign);
  imul(rax, rcx);
  shr(rax, 32);
  finish(at->rd, eax);
}

/// Cycles go with the divisor's leading zeros, or ones less one when it is negative: see divide_extra_signed.
void Emitter::emit_divide(const Instruction* at, bool is_signed, bool remainder) {
  copy(ecx, at->rs2);
  if (is_signed) {
    mov(edx, ecx);
    sar(edx, 31);
    mov(eax, edx);
    xor_(edx, ecx);
    lzcnt(edx, edx);
    add(edx, eax);  // -1 when negative
  } else {
    lzcnt(edx, ecx);
  }
  if (options_.banks != nullptr) {
    shl(edx, std::countr_zero(options_.banks->count()));
    add(r15, rdx);
  } else {
    sub(r15, rdx);
  }
  copy(eax, at->rs1);
  Label by_zero;
  Label done;
  test(ecx, ecx);
  jz(by_zero, T_NEAR);
  if (is_signed) {
    // In 64 bits, -2^31 / -1 is a number like any other.
    movsxd(rax, eax);
    movsxd(rcx, ecx);
    cqo();
    idiv(rcx);
  } else {
    xor_(edx, edx);
    div(ecx);
  }
  if (remainder) mov(eax, edx);
  L(done);
  finish(at->rd, eax);
  later([this, by_zero, done, remainder]() mutable {
    L(by_zero);
    if (!remainder) mov(eax, ~0U);  // the remainder is the dividend
    jmp(done, T_NEAR);
  });
}

}  // namespace mebots::soc::translate
