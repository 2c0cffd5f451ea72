// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <xbyak/xbyak.h>

#include <cstdint>

/// Instructions of the host under one name each, so that the column of translations can say which: Xbyak's members
/// have several forms and default arguments, so none has an address that a template takes.
namespace mebots::soc::translate::host {

using Code = Xbyak::CodeGenerator;
using Xbyak::Reg32;
using Xbyak::Xmm;

/// to = to op from; of one operand: to = op from
using Binary = void (*)(Code&, const Reg32& to, const Xbyak::Operand& from);
inline void sub(Code& c, const Reg32& to, const Xbyak::Operand& from) {
  c.sub(to, from);
}
inline void imul(Code& c, const Reg32& to, const Xbyak::Operand& from) {
  c.imul(to, from);
}
inline void bit_xor(Code& c, const Reg32& to, const Xbyak::Operand& from) {
  c.xor_(to, from);
}
inline void bit_or(Code& c, const Reg32& to, const Xbyak::Operand& from) {
  c.or_(to, from);
}
inline void bit_and(Code& c, const Reg32& to, const Xbyak::Operand& from) {
  c.and_(to, from);
}
inline void tzcnt(Code& c, const Reg32& to, const Xbyak::Operand& from) {
  c.tzcnt(to, from);
}
inline void popcnt(Code& c, const Reg32& to, const Xbyak::Operand& from) {
  c.popcnt(to, from);
}
// By the flags of to - from:
inline void cmovg(Code& c, const Reg32& to, const Xbyak::Operand& from) {
  c.cmovg(to, from);
}
inline void cmova(Code& c, const Reg32& to, const Xbyak::Operand& from) {
  c.cmova(to, from);
}
inline void cmovl(Code& c, const Reg32& to, const Xbyak::Operand& from) {
  c.cmovl(to, from);
}
inline void cmovb(Code& c, const Reg32& to, const Xbyak::Operand& from) {
  c.cmovb(to, from);
}

/// to = to op value
using Immediate = void (*)(Code&, const Reg32& to, std::uint32_t value);
inline void bit_xor(Code& c, const Reg32& to, std::uint32_t value) {
  c.xor_(to, value);
}
inline void bit_or(Code& c, const Reg32& to, std::uint32_t value) {
  c.or_(to, value);
}
inline void bit_and(Code& c, const Reg32& to, std::uint32_t value) {
  c.and_(to, value);
}

/// By a number of places below 32.
using ShiftImmediate = void (*)(Code&, const Reg32& to, int places);
inline void shl(Code& c, const Reg32& to, int places) {
  c.shl(to, places);
}
inline void shr(Code& c, const Reg32& to, int places) {
  c.shr(to, places);
}
inline void sar(Code& c, const Reg32& to, int places) {
  c.sar(to, places);
}

/// By the low five bits of a register.
using Shift = void (*)(Code&, const Reg32& to, const Reg32& from, const Reg32& by);
inline void shlx(Code& c, const Reg32& to, const Reg32& from, const Reg32& by) {
  c.shlx(to, from, by);
}
inline void shrx(Code& c, const Reg32& to, const Reg32& from, const Reg32& by) {
  c.shrx(to, from, by);
}
inline void sarx(Code& c, const Reg32& to, const Reg32& from, const Reg32& by) {
  c.sarx(to, from, by);
}

/// A byte from the flags.
using Set = void (*)(Code&, const Xbyak::Reg8& to);
inline void setl(Code& c, const Xbyak::Reg8& to) {
  c.setl(to);
}
inline void setb(Code& c, const Xbyak::Reg8& to) {
  c.setb(to);
}
inline void setle(Code& c, const Xbyak::Reg8& to) {
  c.setle(to);
}
inline void setbe(Code& c, const Xbyak::Reg8& to) {
  c.setbe(to);
}

/// A far jump by the flags.
using Branch = void (*)(Code&, const Xbyak::Label& to);
inline void je(Code& c, const Xbyak::Label& to) {
  c.je(to, Code::T_NEAR);
}
inline void jne(Code& c, const Xbyak::Label& to) {
  c.jne(to, Code::T_NEAR);
}
inline void jl(Code& c, const Xbyak::Label& to) {
  c.jl(to, Code::T_NEAR);
}
inline void jge(Code& c, const Xbyak::Label& to) {
  c.jge(to, Code::T_NEAR);
}
inline void jb(Code& c, const Xbyak::Label& to) {
  c.jb(to, Code::T_NEAR);
}
inline void jae(Code& c, const Xbyak::Label& to) {
  c.jae(to, Code::T_NEAR);
}

/// On all halves (w) or bytes (b): to = to op from; of one operand: to = op from
using Packed = void (*)(Code&, const Xmm& to, const Xmm& from);
inline void paddw(Code& c, const Xmm& to, const Xmm& from) {
  c.paddw(to, from);
}
inline void paddb(Code& c, const Xmm& to, const Xmm& from) {
  c.paddb(to, from);
}
inline void psubw(Code& c, const Xmm& to, const Xmm& from) {
  c.psubw(to, from);
}
inline void psubb(Code& c, const Xmm& to, const Xmm& from) {
  c.psubb(to, from);
}
inline void pminsw(Code& c, const Xmm& to, const Xmm& from) {
  c.pminsw(to, from);
}
inline void pminsb(Code& c, const Xmm& to, const Xmm& from) {
  c.pminsb(to, from);
}
inline void pminuw(Code& c, const Xmm& to, const Xmm& from) {
  c.pminuw(to, from);
}
inline void pminub(Code& c, const Xmm& to, const Xmm& from) {
  c.pminub(to, from);
}
inline void pmaxsw(Code& c, const Xmm& to, const Xmm& from) {
  c.pmaxsw(to, from);
}
inline void pmaxsb(Code& c, const Xmm& to, const Xmm& from) {
  c.pmaxsb(to, from);
}
inline void pmaxuw(Code& c, const Xmm& to, const Xmm& from) {
  c.pmaxuw(to, from);
}
inline void pmaxub(Code& c, const Xmm& to, const Xmm& from) {
  c.pmaxub(to, from);
}
inline void pabsw(Code& c, const Xmm& to, const Xmm& from) {
  c.pabsw(to, from);
}
inline void pabsb(Code& c, const Xmm& to, const Xmm& from) {
  c.pabsb(to, from);
}

}  // namespace mebots::soc::translate::host
