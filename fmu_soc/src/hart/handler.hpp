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

/// How a handler ends: it calls the next one of its block, which the optimiser makes a jump. Where it does not (no
/// optimisation, sanitizers), it gives the next one back.
[[gnu::always_inline]] inline const Instruction* next(Execution& e, const Instruction* at) {
  if constexpr (kChain) {
    return at[1].run(e, at + 1);
  } else {
    return at + 1;
  }
}

/// A load across two words: a cycle more, behind which a jump that follows hides all but one of its own.
[[gnu::always_inline]] inline void misaligned_load(Execution& e, const Instruction* at) {
  e.extra_cycles += kMisalignedExtra;
  e.slow_load = at;
  if (is_jump(at[1].op) && at[1].rs1 != at->rd) {
    e.extra_cycles -= static_cast<std::uint32_t>(at[2].cycles_before - at[1].cycles_before - 1);
  }
}

/// Handler of an Xpulp operation, and of the end of a block that a hardware loop may end; null for others.
Handler xpulp_handler_of(Op op, Operand operand);

}  // namespace mebots::soc
