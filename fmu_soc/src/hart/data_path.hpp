// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/execution.hpp"
#include "hart/pmp.hpp"
#include "memory/bus.hpp"
#include "memory/memory.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace mebots::soc {

/// A range of a core's address map that leads to a memory.
struct MemoryPort {
  std::size_t region = 0;         // index in Memory::regions()
  std::uint32_t wait_cycles = 0;  // added to the cycles of every load and store
  BankSchedule* banks = nullptr;  // banks that other cores or the DMA also use; null = no other user
  std::uint32_t moved =
      0;  // address in this core's map minus the memory's own address; if not 0, the fast path is not used
};

/// Performs loads and stores outside the fast path: to other memories, across the end of a memory, to devices, to code,
/// and to words that the host watches.
class DataPath {
 public:
  /// If `finishes_block` is true, a block that stores into code continues to its end with the old code. The block is
  /// invalidated afterwards.
  DataPath(Execution& execution, Memory& memory, Bus& bus, bool finishes_block)
      : execution_(execution), memory_(memory), bus_(bus), finishes_block_(finishes_block) {}

  /// Sets the memories of the core. Returns true if the memories of the fast path have changed, or if a wait that
  /// translated code contains as a constant has changed.
  bool connect(std::span<const MemoryPort> ports);
  /// Sets the banks of the core's first memory, if other cores or the DMA also use this memory. Null means that the
  /// core is the only user.
  void share_first(BankSchedule* banks);
  std::uint32_t longest_wait() const;

  /// Disables the fast path if `guarded` is true, so that the data path checks the rights of the privilege mode for
  /// each access. Otherwise enables it.
  void guard(bool guarded);

  // These functions execute an instruction. They return the next instruction of the block, or null if execution leaves
  // the block.
  const Instruction* load(const Instruction* at, std::uint32_t address, unsigned size, bool sign);
  const Instruction* store(const Instruction* at, std::uint32_t address, unsigned size, std::uint32_t value);
  /// Executes p.elw, a load that waits for an event.
  const Instruction* event_load(const Instruction* at);
  const Instruction* load_reserved(const Instruction* at, std::uint32_t address);
  const Instruction* store_conditional(const Instruction* at, std::uint32_t address, std::uint32_t value);
  /// Executes an amo*.w instruction: stores `combine(word, value)`, and loads the previous word into rd.
  const Instruction* amo(const Instruction* at, std::uint32_t address, std::uint32_t value,
                         std::uint32_t (*combine)(std::uint32_t word, std::uint32_t value));
  /// Returns true if one memory of the core contains all of these bytes.
  bool is_ram(std::uint32_t address, unsigned size) const { return port_of(address, size) != nullptr; }
  /// Performs a load from a device if Bus::load_quietly() can perform it. The address must be outside the core's
  /// memories. Does not extend the sign. If blocks may run past the limit (loose limit), performs no load, because each
  /// device access must then end the run.
  BusReply load_quietly(std::uint64_t cycle, std::uint32_t address, unsigned size) noexcept;
  /// Handles a store to code or to a word that the host watches. Returns the next instruction of the block, or null if
  /// execution leaves the block.
  const Instruction* stored_over_mark(const Instruction* at, std::uint32_t address, unsigned size);

 private:
  bool forbids(std::uint32_t address, unsigned size, Pmp::Access access) const;
  /// Returns a pointer to the word of an atomic operation, and counts the wait cycles of the access. If the address is
  /// misaligned, forbidden or outside RAM, raises the exception and returns null.
  std::uint8_t* atomic_word(const Instruction* at, std::uint32_t address, bool only_loads);
  const Instruction* stored_atomic(const Instruction* at, std::uint32_t address);
  const MemoryPort* port_of(std::uint32_t address, unsigned size) const;
  void wait_for_ram(const Instruction* at, const MemoryPort& port, std::uint32_t address, unsigned size);
  const Instruction* finish_load(const Instruction* at, std::uint32_t address, const BusReply& reply);

  Execution& execution_;
  Memory& memory_;
  Bus& bus_;
  bool finishes_block_;
  bool guarded_ = false;
  /// Spans of the two fast regions, which are set to 0 while the fast path is off.
  std::array<std::uint32_t, 2> spans_{};
  std::vector<MemoryPort> ports_;
};

/// Result of wait_for_far() if it did not perform the access.
inline constexpr std::uint64_t kOutsideBanks = std::numeric_limits<std::uint64_t>::max();

/// Performs an access of translated code to a word of the second memory, which several cores share. Counts the access,
/// claims the word's bank for an instruction that starts in active cycle `cycle`, and returns the wait cycles. `offset`
/// is relative to the start of the memory. If the block might end after the last row of the table of the first memory's
/// banks, has no effect and returns kOutsideBanks. The interpreter must then perform the access.
std::uint64_t wait_for_far(Execution& execution, std::uint64_t cycle, std::uint32_t offset) noexcept;

}  // namespace mebots::soc
