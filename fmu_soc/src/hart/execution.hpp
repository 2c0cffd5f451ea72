// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/instruction.hpp"
#include "memory/banks.hpp"

#include <array>
#include <cstdint>

namespace mebots::soc {

class Hart;

/// A piece of RAM as the inner loop sees it.
struct FastRegion {
  std::uint32_t base = 0;
  std::uint32_t span = 0;  // size - 3; 0 = no region
  std::uint8_t* data = nullptr;
  std::uint8_t* marks = nullptr;
  std::uint32_t wait_cycles = 0;  // added to every access: the way there and back
  BankSchedule* banks = nullptr;  // who else uses it; null = nobody
};

/// Why a block was left other than by a branch or at its end.
enum class Leave : std::uint8_t { normal, trap, device, stop, sleep, event, turn };

/// Registers of a hardware loop. The body runs once more after its last instruction while the count is above 1.
struct HardwareLoop {
  std::uint32_t start = 0;
  std::uint32_t end = 0;  // address of the last instruction of the body
  std::uint32_t count = 0;
};

/// What translated code leaves behind, and what it finds its way with.
struct HostState {
  std::int64_t remaining = 0;              // of its budget of cycles
  std::uint64_t instructions = 0;          // retired; upper half: loads and stores
  std::uint64_t instruction_fj = 0;        // their energy
  const void* targets = nullptr;           // code of indirect jumps
  const Instruction* came_from = nullptr;  // the end of the block from which a region's block was reached straight
  const Instruction* slow_load = nullptr;  // the last load across two words
  std::uint64_t slow_load_when = 0;        // what `instructions` was then: of its block if they still are
  // Of the banks of the first memory.
  std::uint8_t* taken = nullptr;  // Banks::taken(), null when nobody else uses it
  std::uint64_t limit_tick = 0;   // the tick of the limit
  std::int64_t claims_above = 0;  // with more cycles remaining, no claim of a block lies outside the banks' window
};

/// What the handlers work on.
struct Execution {
  std::array<std::uint32_t, 33> x{};  // x[0] stays 0; x[32] takes what is written to x0
  std::uint32_t pc = 0;
  std::array<HardwareLoop, 2> loops{};  // 0 is the inner one
  FastRegion ram[2];
  std::uint64_t far_accesses = 0;  // loads and stores that went to ram[1], since reset

  // Of the block in progress.
  std::uint32_t extra_cycles = 0;          // beyond the static ones
  std::uint32_t first_stall = 0;           // of them: what the first instruction waits for a load, from its start on
  const Instruction* exit = nullptr;       // everything before it has retired
  std::uint32_t* link = nullptr;           // where to note the block that follows
  bool jumped = false;                     // an unaligned target costs a cycle
  bool redirected = false;                 // left by a branch, jump, trap or return from one
  const Instruction* slow_load = nullptr;  // the last misaligned load
  const Instruction* waits_at = nullptr;   // the block stands before it: its line is not there yet, or somebody looks
  Leave leave = Leave::normal;
  std::uint32_t trap_cause = 0;
  std::uint32_t trap_value = 0;
  Hart* hart = nullptr;
  HostState host;
};

}  // namespace mebots::soc
