// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isa/encoding.hpp"
#include "isa/op.hpp"

#include <cstddef>
#include <cstdint>

namespace mebots::soc {

struct Execution;
struct Instruction;

/// Executes one instruction. Returns the next instruction of the block. If execution leaves the block, returns null.
using Handler = const Instruction* (*)(Execution&, const Instruction*);

/// Number of a register that no instruction reads. It replaces x0 as destination register (rd).
inline constexpr std::uint8_t kNoRegister = kRegisters;

/// A decoded instruction in a block. It contains the sums of cycles, accesses and energy over all previous instructions
/// of the block. When execution leaves the block, these sums are added to the counters once. So counting has no cost
/// per instruction.
struct Instruction {
  Handler run = nullptr;
  std::int32_t imm = 0;  // absolute address for jumps and branches, value for auipc; operand_value() of Xpulp
  std::uint32_t pc = 0;  // its end is the pc of the next slot
  std::uint8_t rd = 0;   // kNoRegister instead of 0
  std::uint8_t rs1 = 0;
  std::uint8_t rs2 = 0;    // Xpulp: also the number of a loop, the value of p.beqimm
  std::uint8_t index = 0;  // instructions before it
  Op op = Op::end_of_block;
  std::uint16_t cycles_before = 0;  // static cycles
  std::uint32_t energy_before_fj = 0;
  std::uint8_t accesses_before = 0;  // loads and stores
  mutable std::uint16_t link = 0;    // block that follows if the block is left here; 0 = not known yet
};
static_assert(sizeof(Instruction) == 32 || sizeof(void*) != 8);

/// Returns the number of the third register that a fused multiply-add reads.
constexpr std::uint8_t third_register(const Instruction& instruction) {
  return static_cast<std::uint8_t>(static_cast<std::uint32_t>(instruction.imm) >> 8);
}

/// Returns the handler of an operation whose second operand is of this kind.
Handler handler_of(Op op, Operand operand = Operand::reg);

/// Computes the value of rd from the value of rs1 and the second operand. If the operation also has other effects,
/// compute_of() returns null.
using Compute = std::uint32_t (*)(std::uint32_t a, std::uint32_t b);
Compute compute_of(Op op);
/// The condition under which a branch is taken. If the operation is not a branch, compare_of() returns null.
using Compare = bool (*)(std::uint32_t a, std::uint32_t b);
Compare compare_of(Op op);

/// Returns the kind of the second operand. The handler of the instruction determines this kind.
Operand operand_of(const Instruction& instruction);

struct Instruction;

/// A step from one instruction to the next that may enter another function. It includes the hart's counts since reset.
/// Translated code records the counts in its own form, and the hart converts them for the observer.
struct Flow {
  std::uint64_t instructions = 0;    // as recorded: of the run; upper half: loads and stores
  std::uint64_t instruction_fj = 0;  // as recorded: of the run
  std::uint64_t cycles = 0;          // as recorded: the cycle count (HostState::position)
  std::uint64_t far_accesses = 0;
  std::uint64_t fetch_cycles = 0;
  std::uint64_t accesses = 0;
  const Instruction* at = nullptr;  // the instruction that was left
  std::uint32_t next = 0;           // address of the next instruction
};
static_assert(offsetof(Flow, instruction_fj) == offsetof(Flow, instructions) + 8, "both are one vector register");

/// Finds the steps that may enter another function. It is not used for calls and indirect jumps, because these are
/// always recorded.
class FlowMap {
 public:
  FlowMap() = default;
  FlowMap(const FlowMap&) = default;
  FlowMap& operator=(const FlowMap&) = default;
  virtual ~FlowMap() = default;

  virtual bool may_leave_function(std::uint32_t pc, std::uint32_t next) const = 0;
};

}  // namespace mebots::soc
