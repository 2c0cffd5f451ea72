// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace mebots::soc {

struct Instruction;

/// A step from one instruction to the next that may lead into another function, and what the hart had counted since
/// its reset when it was taken. Translated code notes it as it has the counts; the hart makes them those that an
/// observer sees.
struct Flow {
  std::uint64_t instructions = 0;    // as noted: of the run; upper half: loads and stores
  std::uint64_t instruction_fj = 0;  // as noted: of the run
  std::uint64_t cycles = 0;          // as noted: where the count of cycles stood (HostState::position)
  std::uint64_t far_accesses = 0;
  std::uint64_t fetch_cycles = 0;
  std::uint64_t accesses = 0;
  const Instruction* at = nullptr;  // who led there
  std::uint32_t next = 0;           // where it led
};
static_assert(offsetof(Flow, instruction_fj) == offsetof(Flow, instructions) + 8, "both are one vector register");

/// Tells which steps lead into another function, beside calls and jumps by a register, which always may.
class FlowMap {
 public:
  FlowMap() = default;
  FlowMap(const FlowMap&) = default;
  FlowMap& operator=(const FlowMap&) = default;
  virtual ~FlowMap() = default;

  virtual bool leads_away(std::uint32_t pc, std::uint32_t next) const = 0;
};

}  // namespace mebots::soc
