// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/block_cache.hpp"
#include "hart/execution.hpp"

#include <cstdint>
#include <memory>
#include <vector>

/// Translation of hot blocks to host code. All counts are equal to those of the interpreter. Costs that are known after
/// decoding are counted when execution leaves a block. All other costs are counted when they occur. Translated code
/// leaves a block before a rare instruction, which the interpreter executes. Afterwards, execution continues in
/// translated code if the next block has code.
namespace mebots::soc::translate {

class Assembler;

/// Describes where and how translated code was left.
struct Exit {
  bool resumes = false;   // left at `at` inside its block, which the interpreter finishes; else left before a block
  bool fetches = false;   // if resumes: lines of `at` may be absent
  bool indirect = false;  // the code has stored the pc in Execution::pc
  bool jumped = false;    // the cycle of an unaligned target is not yet spent
  bool straight = false;  // left at the end of a block by fall-through; `at` is the slot after its last instruction
  bool is_reached_straight =
      false;  // the block may have been entered by fall-through; see HostState::straight_pipeline
  std::uint32_t pc = 0;
  std::uint32_t block = 0;  // the block at `pc`; 0 = not known
  const Instruction* at =
      nullptr;  // if resumes: the next instruction; else the one that led here, or null if its link is not used
  std::uint32_t wait_cycles = 0;  // if resumes: constant waits for memories in its block so far
  std::uint32_t patch_point = 0;  // the patch point that was left by, which can be chained to code at `pc`; 0 = none
};

/// The entries of a block's code.
struct Entry {
  const std::uint8_t* plain = nullptr;
  const std::uint8_t* jumped = nullptr;    // spends the cycle of an unaligned target first
  const std::uint8_t* straight = nullptr;  // after fall-through from another block; see HostState::straight_pipeline
  const std::uint8_t* stalled = nullptr;   // after fall-through from a load for which the first instruction stalls
  std::uint32_t region = 0;                // number of the region that has the code
};

/// Describes how a run ended.
struct RunEnd {
  /// The last exit. Null if the next hart of the round has no resume point, or after a rare instruction.
  const Exit* exit = nullptr;
  Execution* execution = nullptr;  // hart of that exit; null = all harts have reached their limits
};

/// Function that translated code calls at a rare instruction, with all state in memory. `exit` is the number of the
/// exit before the instruction. The function executes the rest of the block. It returns the code of the next block, for
/// which it has set HostState::begin. If translated code must be left, it returns null.
using Perform = const std::uint8_t*(__attribute__((sysv_abi)) *)(Execution& execution, std::uint64_t exit);

/// Options of a translator: properties that all harts with this code share.
struct Options {
  bool loose_limit = false;  // a block that starts before the limit runs to its end
  Banks* banks = nullptr;    // of the first memory, if other cores use it at times
  /// If not null, steps between functions are recorded at HostState::flow, at most one per instruction.
  const FlowMap* flow = nullptr;
  /// If null, translated code is left at each rare instruction.
  Perform perform = nullptr;
};

/// Translations of the blocks of a cache, for harts that have the same memories at the same addresses. Each block is
/// translated once, as part of one region. A region is dropped if one of its blocks becomes invalid, or to make space.
class Translator : public BlockListener {
 public:
  /// Returns the entries of a block; null if it has no code.
  const Entry* find(std::uint32_t block) const {
    return block < entries_.size() && entries_[block].plain != nullptr ? &entries_[block] : nullptr;
  }
  /// Translates a block that has no code.
  virtual const Entry& translate(std::uint32_t block) = 0;
  /// Runs `code` of an entry up to the hart's limit. If the hart has reached its limit, continues with the next harts
  /// of the round. The result is valid until the next translation.
  virtual RunEnd run(Execution& execution, const std::uint8_t* code) = 0;
  /// Returns an exit by its number. The result is valid until the next translation.
  virtual const Exit& exit(std::uint64_t number) const = 0;
  /// Chains blocks: makes the patch point of the last run's exit lead to the code of `block`. The last run must have
  /// ended before `block`. `stalled` is true if the block's first instruction stalls for a load.
  virtual void chain_last_exit(const Block& block, const Entry& entry, bool stalled) = 0;
  /// Returns the number of times that regions were dropped. A resume point that is older than the last drop may be
  /// invalid.
  virtual std::uint64_t times_dropped() const = 0;
  /// Returns the number of translated instructions. If an instruction is translated again, it is counted again.
  virtual std::uint64_t translated() const = 0;

 protected:
  std::vector<Entry> entries_;  // by number of the block
};

/// True if this build contains the translator and the host's processor has the required instructions.
bool can_translate();

/// True if some form of this operation can be translated. Only the interpreter executes all other operations.
bool has_translation(Op op);

/// Writes host code for an instruction. Returns false, without effect, if the interpreter must execute this form of the
/// instruction.
using Lowering = bool (*)(Assembler&, const Instruction*);

/// Returns the lowering of an operation. If the interpreter executes all forms of the operation, returns null.
Lowering lowering_of(Op op);

/// Returns null if translation is not possible on this host or for these memories. `execution` contains the memories.
std::unique_ptr<Translator> make_translator(const BlockCache& blocks, const Execution& execution,
                                            const Options& options);

}  // namespace mebots::soc::translate
