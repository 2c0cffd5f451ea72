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

/// Fetches instructions through the instruction cache, if the core has one. A cache line is only fetched when the core
/// reaches an instruction in it. Therefore the limits of runs do not change the refills and their cycles.
class Fetch {
 public:
  /// If `cache` is null, fetches never wait.
  Fetch(Execution& execution, InstructionCache* cache) : execution_(execution), cache_(cache) {}

  bool is_cached() const { return cache_ != nullptr; }
  const InstructionCache* cache() const { return cache_; }
  void flush();
  /// Undoes refills of translated code: see InstructionCache::undo_refills(). Subtracts the cycles that the core has
  /// waited for these refills from its counter, and returns them.
  std::uint32_t undo_refills(std::uint32_t lines) {
    MEBOTS_ASSERT(is_cached());
    const auto cycles = cache_->undo_refills(lines) * cache_->refill_cycles();
    execution_.counters.fetch_cycles -= cycles;
    return cycles;
  }
  /// Fetches the cache lines of an instruction that the core reaches in active cycle `cycle`. Returns the wait cycles.
  std::uint32_t fetch_lines(const Instruction* at, std::uint64_t cycle);
  /// Returns true if `at` is in the cache line in which the previous instruction `before` ends.
  bool shares_line(const Instruction* before, const Instruction* at) const {
    MEBOTS_ASSERT(is_cached());
    return cache_->line_of(before[1].pc - 1) == cache_->line_of(at[1].pc - 1);
  }
  /// Returns the first instruction after `at` that may have to wait for a cache line, or the end of the block.
  const Instruction* next_to_wait(const Instruction* at) const;
  /// Returns true if the cache contains all lines from this instruction to the end of the block.
  bool is_present(const Instruction* at) const;

 private:
  Execution& execution_;
  InstructionCache* cache_;
};

/// Returns the value that a core is about to store at `address`. Executes the next instructions from `pc` with the
/// registers `x`, without side effects. Returns nullopt if none of the next 32 instructions stores a word there. Also
/// returns nullopt if one of them first stores elsewhere in the same eight bytes, loads from a device, accesses a CSR,
/// or raises an exception.
std::optional<std::uint32_t> upcoming_store(const Memory& memory, std::uint32_t pc, std::array<std::uint32_t, 32> x,
                                            std::uint32_t address);

}  // namespace mebots::soc
