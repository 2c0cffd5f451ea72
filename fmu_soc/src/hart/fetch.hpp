// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/execution.hpp"
#include "mebots/assert.hpp"
#include "memory/instruction_cache.hpp"

#include <cstdint>

namespace mebots::soc {

/// How a core's instructions come through the instruction cache, where there is one. An instruction waits for its lines
/// when it is reached, never before. So a core that was stopped anywhere has made the same refills in the same cycles.
class Fetch {
 public:
  /// `cache`: null without one.
  Fetch(Execution& execution, InstructionCache* cache) : execution_(execution), cache_(cache) {}

  bool is_cached() const { return cache_ != nullptr; }
  const InstructionCache* cache() const { return cache_; }
  void flush();
  /// Brings the lines of an instruction that is reached in active cycle `cycle`: the cycles that it waits.
  std::uint32_t bring(const Instruction* at, std::uint64_t cycle);
  /// Whether an instruction lies in the line in which the one before it in the block ends.
  bool shares_line(const Instruction* before, const Instruction* at) const {
    MEBOTS_ASSERT(is_cached());
    return cache_->line_of(before[1].pc - 1) == cache_->line_of(at[1].pc - 1);
  }
  /// The first instruction of the block behind `at` that may have to wait, or the end of the block.
  const Instruction* next_to_wait(const Instruction* at) const;
  /// Whether all lines of a block from this instruction on have arrived, whoever asks.
  bool is_present(const Instruction* at) const;

 private:
  Execution& execution_;
  InstructionCache* cache_;
};

}  // namespace mebots::soc
