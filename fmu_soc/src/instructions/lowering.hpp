// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "translate/assembler.hpp"

#include <utility>

/// Writers of host code that several operations share. Most of them take a function that writes the host instruction of
/// one operation.
namespace mebots::soc::lowering {

using namespace Xbyak::util;
using translate::Assembler;
using translate::kNear;
using Xbyak::Label;
using Xbyak::Reg32;
using Xbyak::Xmm;

/// Writes code for rd = rs1 op rs2. `apply(to, from)` must write the host instruction for `to = to op from`.
template <typename Apply>
void emit_binary(Assembler& c, const Instruction* at, Apply apply) {
  const auto to = c.registers.place(at->rd, eax, at->rd == at->rs2 && at->rd != at->rs1);
  c.registers.copy(to, at->rs1);
  if (at->rs2 == 0) {
    c.mov(ecx, 0);
    apply(to, static_cast<const Xbyak::Operand&>(ecx));
  } else {
    apply(to, c.registers.source(at->rs2, ecx));
  }
  c.registers.finish(at->rd, to);
}

/// Writes code for rd = rs1 op immediate. `apply(to, value)` must write the host instruction for `to = to op value`.
template <typename Apply>
void emit_immediate(Assembler& c, const Instruction* at, Apply apply) {
  const auto to = c.registers.place(at->rd, eax);
  c.registers.copy(to, at->rs1);
  apply(to, static_cast<std::uint32_t>(at->imm));
  c.registers.finish(at->rd, to);
}

/// Writes code that shifts rs1 by the low five bits of rs2. `apply(to, from, by)` must write the host instruction.
template <typename Apply>
void emit_shift(Assembler& c, const Instruction* at, Apply apply) {
  const auto to = c.registers.place(at->rd, eax);
  const auto by = c.registers.value(at->rs2, ecx);
  apply(to, c.registers.value(at->rs1, eax), by);
  c.registers.finish(at->rd, to);
}

/// Writes code that copies the second operand (rs2 or the immediate) to `to`.
inline void copy_second(Assembler& c, const Instruction* at, const Reg32& to) {
  if (operand_of(*at) == mebots::soc::Operand::immediate) {
    c.mov(to, static_cast<std::uint32_t>(at->imm));
  } else {
    c.registers.copy(to, at->rs2);
  }
}

/// Writes code for rd = op rs1. `apply(to)` must write the host instruction for `to = op to`.
template <typename Apply>
void emit_unary(Assembler& c, const Instruction* at, Apply apply) {
  c.registers.copy(eax, at->rs1);
  apply(eax);
  c.registers.finish(at->rd, eax);
}

/// Writes code that sets the host's flags to those of rs1 - rs2.
inline void emit_compare(Assembler& c, unsigned rs1, unsigned rs2) {
  if (rs1 != 0 && rs2 == 0) {
    if (c.registers.in_host(rs1)) {
      c.test(c.registers.host(rs1), c.registers.host(rs1));
    } else {
      c.cmp(c.registers.source(rs1, eax), 0);
    }
    return;
  }
  const auto left = c.registers.value(rs1, eax);
  if (rs2 == 0) {
    c.cmp(left, 0);
  } else {
    c.cmp(left, c.registers.source(rs2, ecx));
  }
}

/// Writes code that sets rd to 1 or 0, depending on the host's flags. `set_al()` must write the setcc instruction for
/// al.
template <typename Set>
void finish_set(Assembler& c, unsigned rd, Set set_al) {
  set_al();
  const auto to = c.registers.place(rd, eax);
  c.movzx(to, al);
  c.registers.finish(rd, to);
}
template <typename Set>
void emit_set(Assembler& c, const Instruction* at, Set set_al) {
  emit_compare(c, at->rs1, at->rs2);
  finish_set(c, at->rd, set_al);
}

}  // namespace mebots::soc::lowering
