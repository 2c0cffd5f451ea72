// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isa/encoding.hpp"
#include "isa/op.hpp"

#include <cstddef>
#include <cstdint>

namespace mebots::soc {

struct Execution;
struct Instruction;

/// Executes one instruction and returns the next instruction of the block. If execution leaves the block, returns null.
using Handler = const Instruction* (*)(Execution&, const Instruction*);

/// Number of the register that replaces x0 as destination (rd). No instruction reads it.
inline constexpr std::uint8_t kNoRegister = kRegisters;

/// A decoded instruction of a block. It contains sums of the cycles, accesses and energy of all previous instructions
/// of the block. These sums are added to the counters when execution leaves the block.
struct Instruction {
  Handler run = nullptr;
  /// For jumps and branches, the absolute target; for auipc, its result; for Xpulp, operand_value().
  std::int32_t imm = 0;
  std::uint32_t pc = 0;  // address; the next slot of the block contains the address of the next instruction
  std::uint8_t rd = 0;   // destination register; kNoRegister instead of x0
  std::uint8_t rs1 = 0;
  /// Second source register; for Xpulp, also the number of a hardware loop or the immediate of p.beqimm.
  std::uint8_t rs2 = 0;
  std::uint8_t index = 0;  // number of instructions before this one in the block
  Op op = Op::end_of_block;
  std::uint16_t cycles_before = 0;  // static cycles of the previous instructions of the block
  std::uint32_t energy_before_fj = 0;
  std::uint8_t accesses_before = 0;  // loads and stores of the previous instructions of the block
  /// Number of the next block, if execution leaves the block here; 0 = unknown.
  mutable std::uint16_t link = 0;
};
static_assert(sizeof(Instruction) == 32 || sizeof(void*) != 8);

/// Returns the third source register of a fused multiply-add.
constexpr std::uint8_t third_register(const Instruction& instruction) {
  return static_cast<std::uint8_t>(static_cast<std::uint32_t>(instruction.imm) >> 8);
}

/// Returns the handler of an operation. `operand` is the kind of its second operand.
Handler handler_of(Op op, Operand operand = Operand::reg);

/// Computes the value of rd from the value of rs1 and the second operand. compute_of() returns null for operations with
/// other effects.
using Compute = std::uint32_t (*)(std::uint32_t a, std::uint32_t b);
Compute compute_of(Op op);
/// Returns true if a branch with these operands is taken. compare_of() returns null if the operation is not a branch.
using Compare = bool (*)(std::uint32_t a, std::uint32_t b);
Compare compare_of(Op op);

/// Returns the kind of the second operand, as determined from the instruction's handler.
Operand operand_of(const Instruction& instruction);

struct Instruction;

/// A recorded step from one instruction to the next that may enter another function, with the hart's counts since
/// reset. Translated code records other values in some members. The hart converts them before the observer receives the
/// step.
struct Flow {
  /// In a recorded step, the lower 32 bits count instructions of the run, and the upper 32 bits its loads and stores.
  std::uint64_t instructions = 0;
  std::uint64_t instruction_fj = 0;  // as recorded: energy of the run
  std::uint64_t cycles = 0;          // as recorded: value of HostState::position
  std::uint64_t far_accesses = 0;
  std::uint64_t fetch_cycles = 0;
  std::uint64_t accesses = 0;
  const Instruction* at = nullptr;  // last instruction before the step
  std::uint32_t next = 0;           // address of the first instruction after the step
};
static_assert(offsetof(Flow, instruction_fj) == offsetof(Flow, instructions) + 8, "both are one vector register");

/// Decides which steps from one instruction to the next may enter another function. Calls and indirect jumps are always
/// recorded.
class FlowMap {
 public:
  FlowMap() = default;
  FlowMap(const FlowMap&) = default;
  FlowMap& operator=(const FlowMap&) = default;
  virtual ~FlowMap() = default;

  virtual bool may_leave_function(std::uint32_t pc, std::uint32_t next) const = 0;
};

}  // namespace mebots::soc
