// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/execution.hpp"
#include "memory/bus.hpp"
#include "memory/memory.hpp"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace mebots::soc {

/// A memory as one core reaches it.
struct MemoryPort {
  std::size_t region = 0;         // index in Memory::regions()
  std::uint32_t wait_cycles = 0;  // added to every load and store
  BankSchedule* banks = nullptr;  // who else uses it; null = nobody
  std::uint32_t moved = 0;        // where the core sees it, less its own address; if not 0, never fast
};

/// Loads and stores that do not go the fast way: to memories behind others, across their ends, to devices, over code
/// and watched words.
class DataPath {
 public:
  /// `finishes_block`: behind a store into code the block runs to its end as it was at its start, and is forgotten
  /// then.
  DataPath(Execution& execution, Memory& memory, Bus& bus, bool finishes_block)
      : execution_(execution), memory_(memory), bus_(bus), finishes_block_(finishes_block) {}

  /// True: the fast memories are others, or have other waits that translated code holds.
  bool connect(std::span<const MemoryPort> ports);
  /// The first memory, wherever the core sees it.
  void share_first(BankSchedule* banks);
  std::uint32_t longest_wait() const;

  // Of an instruction; what comes back is what its handler gives.
  const Instruction* load(const Instruction* at, std::uint32_t address, unsigned size, bool sign);
  const Instruction* store(const Instruction* at, std::uint32_t address, unsigned size, std::uint32_t value);
  /// p.elw
  const Instruction* event_load(const Instruction* at);
  /// Behind a store over code or a watched word.
  const Instruction* stored_over_mark(const Instruction* at, std::uint32_t address, unsigned size);

 private:
  const MemoryPort* port_of(std::uint32_t address, unsigned size) const;
  void wait_for_ram(const Instruction* at, const MemoryPort& port, std::uint32_t address, unsigned size);
  const Instruction* finish_load(const Instruction* at, std::uint32_t address, const BusReply& reply);

  Execution& execution_;
  Memory& memory_;
  Bus& bus_;
  bool finishes_block_;
  std::vector<MemoryPort> ports_;
};

/// The answer of `wait_for_far` when it has done nothing.
inline constexpr std::uint64_t kOutsideBanks = std::numeric_limits<std::uint64_t>::max();

/// For translated code, of an access within a word of the second memory, which others use, too: takes its bank for the
/// instruction that starts in active cycle `cycle`, and counts the access. `offset`: from the memory's start. The
/// answer is how many cycles it waits, for the way and for the bank. kOutsideBanks: the rest of the block could lead
/// further than the banks of the first memory reach, where translated code does not look; the interpreter makes the
/// access.
std::uint64_t wait_for_far(Execution& execution, std::uint64_t cycle, std::uint32_t offset) noexcept;

}  // namespace mebots::soc
