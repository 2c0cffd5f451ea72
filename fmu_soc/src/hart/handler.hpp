// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/execution.hpp"
#include "hart/timing.hpp"

namespace mebots::soc {

#if defined(__OPTIMIZE__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && defined(__GNUC__)
inline constexpr bool kChain = true;
#else
inline constexpr bool kChain = false;
#endif

/// Calls the handler of the next instruction. The optimiser turns this call into a jump (threaded code). In builds
/// without optimisation or with sanitizers, returns the next instruction instead.
[[gnu::always_inline]] inline const Instruction* next(Execution& e, const Instruction* at) {
  if constexpr (kChain) {
    return at[1].run(e, at + 1);
  } else {
    return at + 1;
  }
}

/// Takes a conditional branch, and ends its handler.
[[gnu::always_inline]] inline const Instruction* take_branch(Execution& e, const Instruction* at) {
  e.pc = static_cast<std::uint32_t>(at->imm);
  e.extra_cycles += kTakenBranchExtra;
  e.jumped = true;
  e.redirected = true;
  e.exit = at + 1;
  e.link = &at->link;
  return nullptr;
}

}  // namespace mebots::soc
