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

/// A memory in one core's address map.
struct MemoryPort {
  std::size_t region = 0;         // index in Memory::regions()
  std::uint32_t wait_cycles = 0;  // added to every load and store
  BankSchedule* banks = nullptr;  // banks shared with other users; null = no other user
  std::uint32_t moved =
      0;  // address in this core's map minus the memory's own address; if not 0, accesses never use the fast path
};

/// Performs the loads and stores that are not on the fast path: to other memories, across the end of a memory, to
/// devices, to code, or to watched words.
class DataPath {
 public:
  /// If `finishes_block` is true, a block that stores into code runs to its end with the old code. It is invalidated
  /// afterwards.
  DataPath(Execution& execution, Memory& memory, Bus& bus, bool finishes_block)
      : execution_(execution), memory_(memory), bus_(bus), finishes_block_(finishes_block) {}

  /// Sets the memories of the core. Returns true if this changes the fast memories, or a wait that is a constant in
  /// translated code.
  bool connect(std::span<const MemoryPort> ports);
  /// Sets the banks of the first memory, for all addresses at which the core sees this memory. If the core is the only
  /// user, `banks` is null.
  void share_first(BankSchedule* banks);
  std::uint32_t longest_wait() const;

  /// Enables or disables the fast path. Without the fast path, the rights of the privilege mode are checked for each
  /// access.
  void guard(bool guarded);

  // These functions execute an instruction, and return the result of the instruction's handler.
  const Instruction* load(const Instruction* at, std::uint32_t address, unsigned size, bool sign);
  const Instruction* store(const Instruction* at, std::uint32_t address, unsigned size, std::uint32_t value);
  /// p.elw
  const Instruction* event_load(const Instruction* at);
  /// Execute lr.w and sc.w.
  const Instruction* load_reserved(const Instruction* at, std::uint32_t address);
  const Instruction* store_conditional(const Instruction* at, std::uint32_t address, std::uint32_t value);
  /// Executes amo*.w: stores `combine(word, value)`, and loads the previous word.
  const Instruction* amo(const Instruction* at, std::uint32_t address, std::uint32_t value,
                         std::uint32_t (*combine)(std::uint32_t word, std::uint32_t value));
  /// True if one of the core's memories contains these bytes.
  bool is_ram(std::uint32_t address, unsigned size) const { return port_of(address, size) != nullptr; }
  /// Performs a quiet load from a device: see Bus::load_quietly(). The address must be outside the core's memories. If
  /// the limit of runs is loose, no load is quiet, because each access to a device ends the run. Does not extend the
  /// sign.
  BusReply load_quietly(std::uint64_t cycle, std::uint32_t address, unsigned size) noexcept;
  /// Handles a store to code or to a watched word, and continues after the store.
  const Instruction* stored_over_mark(const Instruction* at, std::uint32_t address, unsigned size);

 private:
  bool forbids(std::uint32_t address, unsigned size, Pmp::Access access) const;
  /// Returns the word of an atomic operation, and counts the waits of its access. If the address is misaligned,
  /// forbidden or outside RAM, raises the exception and returns null.
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
  std::array<std::uint32_t, 2> spans_{};  // of the fast regions; the fast path sees 0 while it is off
  std::vector<MemoryPort> ports_;
};

/// Value that wait_for_far() returns if it has not performed the access.
inline constexpr std::uint64_t kOutsideBanks = std::numeric_limits<std::uint64_t>::max();

/// Performs an access of translated code to a word of the shared second memory. The function counts the access, and
/// claims the bank of the word for the instruction that starts in active cycle `cycle`. `offset` is relative to the
/// start of the memory. Returns the cycles that the access waits for the port and the bank. If the rest of the block
/// might run beyond the end of the table of the first memory's banks, the function has no effect and returns
/// kOutsideBanks. In this case, the interpreter performs the access.
std::uint64_t wait_for_far(Execution& execution, std::uint64_t cycle, std::uint32_t offset) noexcept;

}  // namespace mebots::soc
