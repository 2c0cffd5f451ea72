// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/execution.hpp"
#include "translate/region.hpp"
#include "translate/xbyak.hpp"

#include <cstdint>

namespace mebots::soc::translate {

class Assembler;

/// Writes the code that counts cycles (in r15), and instructions, accesses and energy (in xmm15): see Assembler. Also
/// writes the code that claims banks if other cores use the first memory, and the code that records steps that may
/// enter another function.
class CycleAccounting {
 public:
  explicit CycleAccounting(Assembler& assembler) : a_(assembler) {}

  /// Writes code that counts `cycles` cycles.
  void spend(std::uint32_t cycles);
  /// Writes code that counts the number of cycles in the register `cycles`. The code changes this register.
  void spend(const Xbyak::Reg64& cycles);
  /// Writes code that counts the block's instructions up to and including `at`.
  void count(const Instruction* at, std::uint32_t extra_cycles);
  /// Writes code that undoes the code of count().
  void take_back(const Instruction* at);
  /// Returns the wait cycles of the block's accesses before `at`, without waits that are only known at run time.
  std::uint32_t waits_before(const Instruction* at) const;
  /// Writes a jump to `leave`, taken if the limit does not allow the block to begin. `stall` is the number of cycles
  /// that its first instruction stalls.
  void jump_at_limit(const Block& block, std::uint32_t stall, Xbyak::Label& leave);
  /// Writes a jump to `stalled`, taken if `at` is the first instruction of its block and may have stalled after a load.
  /// The cycle of this stall is already counted. `stalled_by` is Block::stalled_by. The code changes rcx and rdx.
  void jump_if_stalled(const Instruction* at, std::uint64_t stalled_by, Xbyak::Label& stalled);
  /// Writes code that copies the number of cycles counted in this run to a register.
  void copy_counted(const Xbyak::Reg64& to);
  /// Writes code that copies the active cycle in which `at` starts. The instruction must not have stalled.
  void copy_start_of(const Instruction* at, const Xbyak::Reg64& to);
  /// Writes code that claims a bank of the first memory for an access, if other cores use this memory.
  void claim_bank(const Instruction* at, bool word_in_ecx);
  /// Writes code that adds the counts of the run to the counters of Execution.
  void add_to_counters();

  // Recording of steps that may enter another function, for observers.

  /// Returns true if an observer needs the step from the instruction `at` to that at address `next`.
  bool is_noted(const Instruction* at, std::uint32_t next) const;
  void record_flow_to(const Instruction* at, std::uint32_t next);
  void record_flow_to(const Instruction* at, const Xbyak::Reg32& next);
  void record_flow_inside(const Instruction* at);

 private:
  template <typename SetNext>
  void record_flow(const Instruction* at, SetNext set_next);

  Assembler& a_;
};

}  // namespace mebots::soc::translate
