// SPDX-License-Identifier: Apache-2.0
#include "hart/execution.hpp"

#include "hart/csr_numbers.hpp"
#include "mebots/assert.hpp"

namespace mebots::soc {

const Instruction* Execution::leave_after(const Instruction* at, Leave why) {
  MEBOTS_ASSERT(!is_block_end(at->op));
  pc = at[1].pc;
  exit = at + 1;
  if (at[1].op == Op::loop_end) at[1].run(*this, at + 1);
  link = nullptr;
  leave = why;
  return nullptr;
}

const Instruction* Execution::leave_before(const Instruction* at, Leave why) {
  MEBOTS_ASSERT(extra_cycles >= stalled_before(at));
  extra_cycles -= stalled_before(at);
  pc = at->pc;
  exit = at;
  link = nullptr;
  leave = why;
  return nullptr;
}

const Instruction* Execution::raise(const Instruction* at, std::uint32_t cause, std::uint32_t value) {
  MEBOTS_ASSERT((cause & cause::kInterrupt) == 0);
  leave_before(at, Leave::trap);
  redirected = true;
  trap_cause = cause;
  trap_value = value;
  return nullptr;
}

}  // namespace mebots::soc
