// SPDX-License-Identifier: Apache-2.0
//
// Traps, Zifencei, Zicsr and machine mode: execution of each operation of isa/system.decode. No operation has a
// lowering.
#include "hart/csr_numbers.hpp"
#include "hart/csrs.hpp"
#include "hart/execution.hpp"
#include "hart/fetch.hpp"
#include "hart/traps.hpp"
#include "instructions/operation.hpp"

namespace mebots::soc::system {
namespace {

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

/// Instructions of machine mode are illegal in U mode. The exception is wfi, which is illegal in U mode only if
/// mstatus.TW is set.
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
