// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace mebots::soc {

/// The cause of a cycle. Each active cycle of a core has exactly one cause.
enum class CycleCause : std::uint8_t {
  base,             // one cycle per retired instruction
  load_use,         // a load has not delivered its register yet
  jump_register,    // jalr: its address register is not ready yet
  jump,             // the rest of jal and jalr, with unaligned targets
  branch,           // the rest of taken branches, with unaligned targets
  multiply_divide,  // the rest of mulh, div, rem
  floats,           // the rest of floating-point operations
  system,           // the rest of CSR accesses and fences
  misaligned,       // the second access to a word
  cache,            // waits for the instruction cache
  memory,           // latency of the first memory
  bank_conflict,    // the bank served another core or the DMA
  far_memory,       // latency and conflicts of the other memories: L2 of a cluster
  device,           // waits for registers of devices, the DMA's among them
  trap,             // entry and return of traps and interrupts
  other,            // no known cause; always 0 unless the account is wrong
};
inline constexpr std::size_t kCycleCauses = static_cast<std::size_t>(CycleCause::other) + 1;

/// Names of the causes in reports, by cause.
inline constexpr std::array<std::string_view, kCycleCauses> kCycleCauseNames{
    "base",       "load_use", "jump_register", "jump",          "branch",     "multiply_divide", "floats", "system",
    "misaligned", "cache",    "memory",        "bank_conflict", "far_memory", "device",          "trap",   "other"};

/// The cycles of an instruction by cause. Their sum is the change of the core's cycle count since the previous
/// instruction. There is one exception: if a misaligned load hides cycles of the following jump, these cycles are
/// subtracted from the load.
struct CycleShares {
  std::array<std::int32_t, kCycleCauses> cycles{};

  std::int32_t& operator[](CycleCause cause) { return cycles[static_cast<std::size_t>(cause)]; }
  std::int32_t operator[](CycleCause cause) const { return cycles[static_cast<std::size_t>(cause)]; }
};

}  // namespace mebots::soc
