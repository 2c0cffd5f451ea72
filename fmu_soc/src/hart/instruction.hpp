// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isa/encoding.hpp"
#include "isa/op.hpp"

#include <cstddef>
#include <cstdint>

namespace mebots::soc {

struct Execution;
struct Instruction;

/// Executes one instruction and gives the next one of the block, or null when the block is left.
using Handler = const Instruction* (*)(Execution&, const Instruction*);

/// A decoded instruction as it stands in a block. Sums over the instructions before it, in the same block,
/// make counting free: who leaves the block at this instruction adds them once.
struct Instruction {
  Handler run = nullptr;
  std::int32_t imm = 0;  // absolute address for jumps and branches, value for auipc; operand_value() of Xpulp
  std::uint32_t pc = 0;  // the following Instruction's pc is this one's end
  std::uint8_t rd = 0;   // 32 instead of 0: a register that nobody reads
  std::uint8_t rs1 = 0;
  std::uint8_t rs2 = 0;  // Xpulp: also the number of a loop, the value of p.beqimm
  Op op = Op::end_of_block;
  std::uint16_t cycles_before = 0;   // static cycles
  std::uint8_t index = 0;            // instructions
  std::uint8_t accesses_before = 0;  // loads and stores
  std::uint32_t energy_before_fj = 0;
  mutable std::uint32_t link = 0;  // block that follows when left here; 0 = not known yet
};
static_assert(sizeof(Instruction) == 32 || sizeof(void*) != 8);

/// Handler of an operation whose second operand comes from there.
Handler handler_of(Op op, Operand operand = Operand::reg);

/// The function of rs1 and the second operand that an operation writes to rd; null if it is not such a function.
using Compute = std::uint32_t (*)(std::uint32_t a, std::uint32_t b);
Compute compute_of(Op op);
/// The condition under which a branch is taken; null for other operations.
using Compare = bool (*)(std::uint32_t a, std::uint32_t b);
Compare compare_of(Op op);

/// Where the second operand of a decoded instruction comes from: its handler knows.
Operand operand_of(const Instruction& instruction);

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

/// Finds the steps that may lead into another function. Calls and jumps by a register always may, and are not queried.
class FlowMap {
 public:
  FlowMap() = default;
  FlowMap(const FlowMap&) = default;
  FlowMap& operator=(const FlowMap&) = default;
  virtual ~FlowMap() = default;

  virtual bool may_leave_function(std::uint32_t pc, std::uint32_t next) const = 0;
};

}  // namespace mebots::soc
