// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/execution.hpp"
#include "mebots/assert.hpp"
#include "memory/instruction_cache.hpp"
#include "memory/memory.hpp"

#include <array>
#include <cstdint>
#include <optional>

namespace mebots::soc {

/// Fetches a core's instructions through the instruction cache, if there is one. An instruction waits for its cache
/// lines only when the core reaches the instruction. Therefore the refills and their cycles do not depend on the limits
/// of runs.
class Fetch {
 public:
  /// If `cache` is null, no fetch waits.
  Fetch(Execution& execution, InstructionCache* cache) : execution_(execution), cache_(cache) {}

  bool is_cached() const { return cache_ != nullptr; }
  const InstructionCache* cache() const { return cache_; }
  void flush();
  /// Fetches the cache lines of an instruction that the core reaches in active cycle `cycle`. Returns the wait cycles.
  std::uint32_t fetch_lines(const Instruction* at, std::uint64_t cycle);
  /// True if `at` lies in the cache line in which the previous instruction, `before`, ends.
  bool shares_line(const Instruction* before, const Instruction* at) const {
    MEBOTS_ASSERT(is_cached());
    return cache_->line_of(before[1].pc - 1) == cache_->line_of(at[1].pc - 1);
  }
  /// Returns the first instruction after `at` that may have to wait for a cache line. If the block has no such
  /// instruction, returns its end.
  const Instruction* next_to_wait(const Instruction* at) const;
  /// True if all lines from this instruction to the end of the block are in the cache.
  bool is_present(const Instruction* at) const;

 private:
  Execution& execution_;
  InstructionCache* cache_;
};

/// Predicts the value that a core is about to store at `address`: executes the next few instructions from `pc` with the
/// registers `x`, without any effect. Returns nullopt if another store to the same eight bytes comes first. Also
/// returns nullopt if an access to a device, an access to a CSR, or a trap comes first.
std::optional<std::uint32_t> upcoming_store(const Memory& memory, std::uint32_t pc, std::array<std::uint32_t, 32> x,
                                            std::uint32_t address);

}  // namespace mebots::soc
