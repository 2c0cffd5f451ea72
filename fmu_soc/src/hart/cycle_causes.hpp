// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace mebots::soc {

/// Causes of cycles. Each active cycle of a core has exactly one cause.
enum class CycleCause : std::uint8_t {
  base,             // first cycle of each retired instruction
  load_use,         // wait for a register that a load has not written yet
  jump_register,    // wait of a jalr for its address register
  jump,             // further cycles of jal and jalr, including unaligned targets
  branch,           // further cycles of taken branches, including unaligned targets
  multiply_divide,  // further cycles of mulh, div and rem
  floats,           // further cycles of floating-point operations
  system,           // further cycles of CSR accesses and fences
  misaligned,       // second bus access of a misaligned load or store
  cache,            // waits for the instruction cache
  memory,           // latency of the core's first memory
  bank_conflict,    // wait for a bank that served another core or the DMA
  far_memory,       // latency and conflicts of the other memories, such as L2 for a cluster
  device,           // waits for device registers, including those of the DMA
  trap,             // entry of traps and interrupts, and return from them
  other,            // unknown cause; always 0 unless CycleAccount has a defect
};
inline constexpr std::size_t kCycleCauses = static_cast<std::size_t>(CycleCause::other) + 1;

inline constexpr std::array<std::string_view, kCycleCauses> kCycleCauseNames{
    "base",       "load_use", "jump_register", "jump",          "branch",     "multiply_divide", "floats", "system",
    "misaligned", "cache",    "memory",        "bank_conflict", "far_memory", "device",          "trap",   "other"};

/// Cycles of an instruction by cause. Their sum is the change of the core's cycle count since the previous instruction.
/// Exception: if cycles of a jump overlap with a misaligned load before it, they are subtracted from the load.
struct CycleShares {
  std::array<std::int32_t, kCycleCauses> cycles{};

  std::int32_t& operator[](CycleCause cause) { return cycles[static_cast<std::size_t>(cause)]; }
  std::int32_t operator[](CycleCause cause) const { return cycles[static_cast<std::size_t>(cause)]; }
};

}  // namespace mebots::soc
