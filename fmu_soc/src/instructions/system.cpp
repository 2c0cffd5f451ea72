// SPDX-License-Identifier: Apache-2.0
//
// Execution of the operations in isa/system.decode: traps, Zifencei, Zicsr and machine mode. Only accesses to CSRs have
// a lowering.
#include "hart/csr_numbers.hpp"
#include "hart/csrs.hpp"
#include "hart/execution.hpp"
#include "hart/fetch.hpp"
#include "hart/traps.hpp"
#include "instructions/operation.hpp"
#ifdef MEBOTS_TRANSLATES
#include "instructions/lowering.hpp"
#endif

namespace mebots::soc::system {
namespace {

#ifdef MEBOTS_TRANSLATES
using namespace lowering;
#endif

const Instruction* execute_illegal(Execution& e, const Instruction* at) {
  return e.raise(at, cause::kIllegalInstruction, static_cast<Word>(at->imm));
}
const Instruction* execute_ecall(Execution& e, const Instruction* at) {
  return e.raise(at, e.units->csrs.call_cause(), 0);
}
const Instruction* execute_ebreak(Execution& e, const Instruction* at) {
  return e.raise(at, cause::kBreakpoint, at->pc);
}

const Instruction* execute_fence_i(Execution& e, const Instruction* at) {
  e.units->fetch.flush();
  return next(e, at);
}

template <Op>
const Instruction* execute_csr_access(Execution& e, const Instruction* at) {
  return e.units->csrs.access(at);
}

#ifdef MEBOTS_TRANSLATES
Xbyak::Address csr_field(const Xbyak::AddressFrame& frame, std::size_t offset) {
  return frame[rdx + static_cast<int>(offset)];
}
Xbyak::Address csr_word(unsigned slot) {
  return csr_field(dword, offsetof(CsrState, words) + sizeof(std::uint32_t) * slot);
}

/// Writes code that loads the address of the core's CsrState into rdx. If the core is not in machine mode, the code
/// jumps to `rare`.
void emit_csr_state(Assembler& c, Label& rare) {
  c.mov(rdx, ptr[rbx + translate::offset_of_host(offsetof(HostState, csrs))]);
  if (!c.blocks.timing().options.has(Extension::user)) return;
  c.cmp(csr_field(byte, offsetof(CsrState, mode)), static_cast<std::uint32_t>(Mode::machine));
  c.jne(rare, kNear);
}

/// Writes code that loads the value of the counter before `at` into rax. rdx must contain the address of the core's
/// CsrState. The code changes rcx. The code jumps to `rare` if the counter is stopped. It also jumps there if `at`
/// reads the cycle counter and may have stalled after a load before its block.
void emit_count(Assembler& c, const Instruction* at, bool instret, Label& rare) {
  c.test(csr_word(csr::slot_of(csr::kMcountinhibit)), instret ? Csrs::kInhibitInstret : Csrs::kInhibitCycle);
  c.jnz(rare, kNear);
  if (instret) {
    c.movd(eax, xmm15);
    c.add(rax, ptr[rbx + translate::offset_of_counter(offsetof(Counters, instructions))]);
    c.sub(rax, csr_field(ptr, offsetof(CsrState, instret_base)));
    if (at->index != 0) c.add(rax, at->index);
    return;
  }
  c.cycles.jump_if_stalled(at, c.edges.block().stalled_by, rare);
  c.cycles.copy_start_of(at, rax);
  c.mov(rdx, ptr[rbx + translate::offset_of_host(offsetof(HostState, csrs))]);
  c.sub(rax, csr_field(ptr, offsetof(CsrState, cycle_base)));
}

/// Writes code that changes a word of CsrState. eax must contain the old value. The code changes ecx.
void emit_csr_write(Assembler& c, const Instruction* at, const CsrForm& form) {
  if (traits_of(at->op).kind == OpKind::csr_immediate) {
    c.mov(ecx, at->rs1);
  } else {
    c.registers.copy(ecx, at->rs1);
  }
  if (at->op == Op::csrrs || at->op == Op::csrrsi) c.or_(ecx, eax);
  if (at->op == Op::csrrc || at->op == Op::csrrci) c.andn(ecx, ecx, eax);
  if (form.written_bits != ~0U) c.and_(ecx, form.written_bits);
  c.mov(csr_word(form.slot), ecx);
}

/// Writes code for reads of counters, and for accesses to plain words. Returns false for all other accesses.
bool emit_csr_access(Assembler& c, const Instruction* at) {
  using Kind = CsrForm::Kind;
  const auto form = Csrs::form(c.blocks.timing(), static_cast<unsigned>(at->imm));
  const bool writes = at->op == Op::csrrw || at->op == Op::csrrwi || at->rs1 != 0;
  if (form.kind == Kind::other || (writes && form.written_bits == 0)) return false;
  Label rare;
  emit_csr_state(c, rare);
  if (form.kind == Kind::word) {
    c.mov(eax, csr_word(form.slot));
    if (writes) emit_csr_write(c, at, form);
  } else {
    emit_count(c, at, form.kind == Kind::instret || form.kind == Kind::instret_high, rare);
    if (form.kind == Kind::cycle_high || form.kind == Kind::instret_high) c.shr(rax, 32);
  }
  if (at->rd != kNoRegister) c.registers.finish(at->rd, eax);
  c.defer_cold([&c, at, rare]() mutable {
    c.L(rare);
    c.edges.resume(at);
  });
  return true;
}
#endif

/// Raises the exception of an instruction that is illegal in U mode: mret, and wfi if mstatus.TW is set.
const Instruction* illegal_in_user_mode(Execution& e, const Instruction* at) {
  return e.raise(at, cause::kIllegalInstruction, e.units->blocks.word_at(at->pc).value_or(0));
}
const Instruction* execute_mret(Execution& e, const Instruction* at) {
  if (e.units->csrs.mode() == Mode::user) return illegal_in_user_mode(e, at);
  return e.units->traps.leave_handler(at);
}
const Instruction* execute_wfi(Execution& e, const Instruction* at) {
  if (e.units->csrs.wait_traps()) return illegal_in_user_mode(e, at);
  return e.leave_after(at, Leave::sleep);
}

}  // namespace

constinit const Operation kOperations[] = {
#include "fmu_soc_isa/system.inc"
};

}  // namespace mebots::soc::system
