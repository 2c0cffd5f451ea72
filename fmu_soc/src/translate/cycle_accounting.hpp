// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/execution.hpp"
#include "translate/region.hpp"
#include "translate/xbyak.hpp"

#include <cstdint>

namespace mebots::soc::translate {

class Assembler;

/// Writes the code that counts cycles (in r15), and instructions, accesses and energy (in xmm15; see assembler.hpp).
/// The code also claims banks of the first memory that cores share, and records steps between functions with the counts
/// at each step.
class CycleAccounting {
 public:
  explicit CycleAccounting(Assembler& assembler) : a_(assembler) {}

  /// Spends cycles.
  void spend(std::uint32_t cycles);
  /// Writes code that counts as many cycles as the register `cycles` contains. Changes this register.
  void spend(const Xbyak::Reg64& cycles);
  /// Writes code that adds the counts of the block's instructions up to and including `at`.
  void count(const Instruction* at, std::uint32_t extra_cycles);
  /// Undoes count().
  void take_back(const Instruction* at);
  /// Returns the wait cycles of the block's memory accesses before `at`, without waits that are only known at run time.
  std::uint32_t waits_before(const Instruction* at) const;
  /// Jumps if the limit does not allow the block to begin.
  void jump_at_limit(const Block& block, std::uint32_t stall, Xbyak::Label& leave);
  /// Jumps to `stalled` if `at` is the first instruction of its block, and may have stalled for a load before the
  /// block. The cycle of this stall is already counted. `stalled_by` is Block::stalled_by. Changes rcx and rdx.
  void jump_if_stalled(const Instruction* at, std::uint64_t stalled_by, Xbyak::Label& stalled);
  /// Copies the number of cycles that the run has counted so far.
  void copy_counted(const Xbyak::Reg64& to);
  /// Copies the active cycle in which `at` starts. The instruction must not have stalled.
  void copy_start_of(const Instruction* at, const Xbyak::Reg64& to);
  /// Claims a bank for an access.
  void claim_bank(const Instruction* at, bool word_in_ecx);
  /// Adds the counts of a run to the counters of Execution.
  void add_to_counters();

  // Steps between functions, for observers.

  /// True if a step must be recorded.
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
