// SPDX-License-Identifier: Apache-2.0
//
// Traps, Zifencei, Zicsr and machine mode: execution of each operation of isa/system.decode. None has a lowering.
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
  return e.raise(at, cause::kMachineEcall, 0);
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

const Instruction* execute_mret(Execution& e, const Instruction* at) {
  return e.units->traps.leave_handler(at);
}
const Instruction* execute_wfi(Execution& e, const Instruction* at) {
  return e.leave_after(at, Leave::sleep);
}

}  // namespace

constinit const Operation kOperations[] = {
#include "fmu_soc_isa/system.inc"
};

}  // namespace mebots::soc::system
