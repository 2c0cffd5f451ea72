// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/block_cache.hpp"
#include "hart/execution.hpp"

#include <cstdint>
#include <memory>
#include <vector>

/// Hot blocks as code of the host. Counts are those of the interpreter to the last unit. What is static in a block is
/// added where it is left; what only execution tells is added when it happens. Everything that is rare goes back
/// to the interpreter in front of the instruction that needs it.
namespace mebots::soc::translate {

class Assembler;

/// How translated code was left.
struct Exit {
  bool resumes = false;              // at `at`, inside its block, which the interpreter finishes; else a block begins
  bool fetches = false;              // resumes: lines of `at` may not have arrived
  bool indirect = false;             // the code has put the pc into Execution::pc
  bool jumped = false;               // an unaligned target costs its cycle yet
  bool straight = false;             // behind the last instruction of a block, which `at` stands behind
  bool is_reached_straight = false;  // its block may be: HostState::straight_pipeline says from where
  std::uint32_t pc = 0;
  std::uint32_t block = 0;          // that begins at `pc`; 0 = not known
  const Instruction* at = nullptr;  // resumes: comes next; else: what led here, null when its link is of no interest
  std::uint32_t wait_cycles = 0;    // resumes: what its block has waited for memories by rule
  std::uint32_t patch_point = 0;    // by which it is left, which can lead to translated code at `pc`; 0 = none
};

/// Where code of a block can be entered.
struct Entry {
  const std::uint8_t* plain = nullptr;
  const std::uint8_t* jumped = nullptr;    // pays for an unaligned target first
  const std::uint8_t* straight = nullptr;  // from the end of a block, which HostState::straight_pipeline says
  const std::uint8_t* stalled = nullptr;   // likewise, from a load that the first instruction waits for a cycle
  std::uint32_t region = 0;                // number of the region that has the code
};

/// How a run ended.
struct RunEnd {
  const Exit* exit = nullptr;      // the last one; null = the next hart of the round has no resume point
  Execution* execution = nullptr;  // whose it was; null = all have come to the end of their budgets
};

/// Translation options: what the harts have in common that the code runs on.
struct Options {
  bool loose_limit = false;  // a block that starts before the limit runs to its end
  Banks* banks = nullptr;    // of the first memory, when others use it at the same time, now and then
  /// Not null: steps between functions are noted at HostState::flow, one an instruction at most.
  const FlowMap* flow = nullptr;
};

/// Translations of a block cache, for harts that reach the same memories at the same place. Each block is translated
/// once, as part of one region. A region is dropped when a block of it becomes invalid, or to make room.
class Translator : public BlockListener {
 public:
  /// Code of a block, or null.
  const Entry* find(std::uint32_t block) const {
    return block < entries_.size() && entries_[block].plain != nullptr ? &entries_[block] : nullptr;
  }
  /// Makes code for a block that has none.
  virtual const Entry& translate(std::uint32_t block) = 0;
  /// Goes on at `code` of an entry with its budget, and when it was left only for the end of that, with the
  /// next ones of the round. The answer holds until the next translation.
  virtual RunEnd run(Execution& execution, const std::uint8_t* code) = 0;
  /// Block chaining: the last run was left to go on at this block; the patch point by which it was left leads to its
  /// code from now on.
  /// `stalled`: its first instruction waits for a load before.
  virtual void chain_last_exit(const Block& block, const Entry& entry, bool stalled) = 0;
  /// How often regions were dropped: where a run goes on may be gone then.
  virtual std::uint64_t times_dropped() const = 0;
  /// Instructions translated so far, those translated again counted again.
  virtual std::uint64_t translated() const = 0;

 protected:
  std::vector<Entry> entries_;  // by number of block
};

/// Whether this build translates, and this host has the instructions for it.
bool can_translate();

/// Whether some form of this operation can be translated; all others are left to the interpreter.
bool has_translation(Op op);

/// Writes host code for an instruction. False: nothing was written, this form of it is left to the interpreter.
using Lowering = bool (*)(Assembler&, const Instruction*);

/// The lowering of an operation; null if all forms are left to the interpreter.
Lowering lowering_of(Op op);

/// Null where that is not so, or code cannot be made for such memories. `execution` says where the memories are.
std::unique_ptr<Translator> make_translator(const BlockCache& blocks, const Execution& execution,
                                            const Options& options);

}  // namespace mebots::soc::translate
