// SPDX-License-Identifier: Apache-2.0
//
// Traps, Zifencei, Zicsr and machine mode: execution of each operation of isa/system.decode. Accesses to CSRs, ecall
// and mret have a lowering.
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

/// Writes the code at `rare`, which lets the interpreter execute the instruction.
void resume_if_rare(Assembler& c, const Instruction* at, Label rare) {
  c.defer_cold([&c, at, rare]() mutable {
    c.L(rare);
    c.edges.resume(at);
  });
}

/// Writes code that stores a word of CsrState. eax must contain the old value. The code changes ecx.
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

/// Writes code for reads of counters, and for accesses to registers that keep a word (CsrForm::Kind::word). Returns
/// false for all other accesses.
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
  resume_if_rare(c, at, rare);
  return true;
}

/// Writes code that loads the addresses of the core's CsrState into rdx and of its TrapState into rcx. If a trap may
/// change a privilege mode, the code jumps to `rare`.
void emit_trap_state(Assembler& c, Label& rare) {
  emit_csr_state(c, rare);
  if (c.blocks.timing().options.has(Extension::user)) {
    c.cmp(csr_field(byte, offsetof(CsrState, modifies_privilege)), 0);
    c.jne(rare, kNear);
  }
  c.mov(rcx, ptr[rbx + translate::offset_of_host(offsetof(HostState, traps))]);
}

/// Writes code that takes the exception of an ecall, as Traps::take_exception() does. In rare cases, the interpreter
/// executes the ecall instead, for example if another exception is being handled, or if the handler has changed since
/// the translation.
bool emit_ecall(Assembler& c, const Instruction* at) {
  static_assert(std::is_standard_layout_v<TrapState> && std::is_standard_layout_v<CsrState>);
  if (c.options.perform == nullptr || at->link == 0 || !c.blocks.block(at->link).valid()) return false;
  const auto handler = c.blocks.block(at->link).pc;
  const auto trap = [](const Xbyak::AddressFrame& frame, std::size_t offset) {
    return frame[rcx + static_cast<int>(offset)];
  };
  constexpr auto kFirst = offsetof(TrapState, fault) + offsetof(Fault, first);
  constexpr auto kLast = offsetof(TrapState, last_exception);
  Label rare;
  c.cmp(byte[rbx + translate::offset_of_host(offsetof(HostState, serves_calls))], 0);
  c.jne(rare, kNear);
  emit_trap_state(c, rare);
  c.cmp(csr_field(dword, offsetof(CsrState, call_handler)), handler);
  c.jne(rare, kNear);
  c.cmp(trap(dword, offsetof(TrapState, repeats)), 0);
  c.jne(rare, kNear);
  if (at->index != 0) c.cycles.count(at - 1, 0);
  c.cycles.spend(kTrapEntryCycles);

  c.mov(trap(dword, offsetof(TrapState, repeats)), 1);
  c.mov(trap(dword, offsetof(TrapState, returns)), 0);
  c.mov(trap(dword, kFirst + offsetof(Exception, cause)), cause::kMachineEcall);
  c.mov(trap(dword, kFirst + offsetof(Exception, pc)), at->pc);
  c.mov(trap(dword, kFirst + offsetof(Exception, value)), 0);
  c.mov(trap(dword, kFirst + offsetof(Exception, instruction)), c.blocks.word_at(at->pc).value_or(0));
  c.registers.copy(eax, Traps::kReturnAddress);
  c.mov(trap(dword, kFirst + offsetof(Exception, return_address)), eax);
  c.registers.copy(eax, Traps::kStackPointer);
  c.mov(trap(dword, kFirst + offsetof(Exception, stack_pointer)), eax);
  c.mov(trap(dword, kLast + offsetof(LastException, pc)), at->pc);
  c.mov(trap(dword, kLast + offsetof(LastException, cause)), cause::kMachineEcall);
  c.movq(rax, xmm15);
  c.shr(rax, 32);
  c.add(rax, ptr[rbx + translate::offset_of_counter(offsetof(Counters, accesses))]);
  c.mov(trap(ptr, kLast + offsetof(LastException, accesses)), rax);
  c.movd(eax, xmm15);
  c.add(rax, ptr[rbx + translate::offset_of_counter(offsetof(Counters, instructions))]);
  c.mov(trap(ptr, kLast + offsetof(LastException, instructions)), rax);

  c.mov(csr_word(csr::slot_of(csr::kMepc)), at->pc);
  c.mov(csr_word(csr::slot_of(csr::kMcause)), cause::kMachineEcall);
  if (c.blocks.timing().has_mtval()) c.mov(csr_word(csr::slot_of(csr::kMtval)), 0);
  c.mov(al, csr_field(byte, offsetof(CsrState, interrupts_on)));
  c.mov(csr_field(byte, offsetof(CsrState, interrupts_were_on)), al);
  c.mov(csr_field(byte, offsetof(CsrState, interrupts_on)), 0);
  c.mov(csr_field(byte, offsetof(CsrState, mode_before)), static_cast<std::uint32_t>(Mode::machine));
  c.edges.enter_handler(at, handler);
  resume_if_rare(c, at, rare);
  return true;
}

/// Writes code that returns from the handler of an exception, as Traps::leave_handler() does. If an interrupt would be
/// taken directly afterwards, the interpreter executes the mret.
bool emit_mret(Assembler& c, const Instruction* at) {
  if (c.options.perform == nullptr) return false;
  const bool has_user = c.blocks.timing().options.has(Extension::user);
  const auto mode_before = csr_field(byte, offsetof(CsrState, mode_before));
  const auto were_on = csr_field(byte, offsetof(CsrState, interrupts_were_on));
  Label rare;
  Label stays_off;
  emit_trap_state(c, rare);
  if (has_user) {
    c.cmp(mode_before, static_cast<std::uint32_t>(Mode::machine));
    c.jne(rare, kNear);
  }
  static_assert(cause::kInterrupt == 1U << 31, "the sign of mcause");
  c.cmp(csr_word(csr::slot_of(csr::kMcause)), 0);
  c.jl(rare, kNear);
  c.cmp(were_on, 0);
  c.je(stays_off);
  c.mov(eax, csr_word(csr::slot_of(csr::kMip)));
  c.test(csr_word(csr::slot_of(csr::kMie)), eax);
  c.jnz(rare, kNear);
  c.L(stays_off);
  c.mov(al, were_on);
  c.mov(csr_field(byte, offsetof(CsrState, interrupts_on)), al);
  c.mov(were_on, 1);
  c.mov(eax, csr_field(dword, offsetof(CsrState, cause_kept_by_return)));
  c.and_(csr_word(csr::slot_of(csr::kMcause)), eax);
  if (has_user) c.mov(mode_before, static_cast<std::uint32_t>(Mode::user));
  c.mov(dword[rcx + static_cast<int>(offsetof(TrapState, repeats))], 0);
  c.mov(dword[rcx + static_cast<int>(offsetof(TrapState, returns))], 0);
  c.mov(dword[rbx + static_cast<int>(offsetof(Execution, cut_pc))], kNoPc);
  c.mov(eax, csr_word(csr::slot_of(csr::kMepc)));
  c.edges.jump_indirect(at);
  resume_if_rare(c, at, rare);
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
