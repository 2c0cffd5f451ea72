// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/block_cache.hpp"
#include "hart/execution.hpp"

#include <cstdint>
#include <memory>
#include <vector>

/// Translation of hot blocks to host code. All counts are equal to those of the interpreter. Some instructions have no
/// host code. Translated code leaves the block before such an instruction, which the interpreter executes. Execution
/// then continues in translated code if the next block has code.
namespace mebots::soc::translate {

class Assembler;

/// Describes where and how execution left translated code.
struct Exit {
  /// If true, code was left at `at` inside a block, which the interpreter finishes; otherwise before a block.
  bool resumes = false;
  bool fetches = false;   // only with `resumes`: cache lines of `at` may be absent
  bool indirect = false;  // if true, the code has stored the pc in Execution::pc
  bool jumped = false;    // if true, the cycle of an unaligned target is not yet counted
  /// If true, code was left at the end of a block without a jump. `at` is then the end of the block.
  bool straight = false;
  bool is_reached_straight =
      false;  // the block may have been entered by fall-through; see HostState::straight_pipeline
  std::uint32_t pc = 0;
  std::uint32_t block = 0;  // number of the block at `pc`; 0 = unknown
  /// If `resumes` is true, the next instruction to execute. Otherwise the instruction (or end of a block) after which
  /// execution continues at `pc`, or null if its link is not used.
  const Instruction* at = nullptr;
  std::uint32_t wait_cycles = 0;  // only with `resumes`: constant waits for memories in the block so far
  std::uint32_t patch_point = 0;  // patch point of this exit, which can be chained to code at `pc`; 0 = none
};

/// Addresses at which execution can enter a block's code.
struct Entry {
  const std::uint8_t* plain = nullptr;
  const std::uint8_t* jumped = nullptr;    // counts the cycle of an unaligned target first
  const std::uint8_t* straight = nullptr;  // after a fall-through from another block; see HostState::straight_pipeline
  /// Entry after a fall-through from a block that ends with a load, if the block's first instruction stalls after this
  /// load.
  const std::uint8_t* stalled = nullptr;
  std::uint32_t region = 0;  // number of the region that contains the code
};

struct RunEnd {
  /// The last exit. Null if translated code reached a hart that has no resume point, or if the run ended after an
  /// instruction without host code.
  const Exit* exit = nullptr;
  Execution* execution = nullptr;  // hart of the last exit; null = all harts have reached their limits
};

/// Function that translated code calls for an instruction without host code, with all state in memory. `exit` is the
/// number of the exit before the instruction. The function executes the rest of the block in the interpreter. It
/// returns the address of the next block's code, after it has set HostState::begin. It returns null if translated code
/// must be left.
using Perform = const std::uint8_t*(__attribute__((sysv_abi)) *)(Execution& execution, std::uint64_t exit);

/// Options that all harts with the same translated code share.
struct Options {
  bool loose_limit = false;  // if true, a block that starts before the limit runs to its end
  Banks* banks = nullptr;    // banks of the first memory, if other cores may use it; otherwise null
  /// If not null, translated code stores steps that may enter another function in the list HostState::flow, at most one
  /// per instruction.
  const FlowMap* flow = nullptr;
  /// Executes an instruction without host code. If null, translated code is left before each such instruction.
  Perform perform = nullptr;
};

/// Translates the blocks of a block cache, for harts that have the same memories at the same addresses. Each block is
/// part of at most one region. A region is dropped if one of its blocks becomes invalid, or to free space.
class Translator : public BlockListener {
 public:
  /// Returns the entries of a block, or null if the block has no code.
  const Entry* find(std::uint32_t block) const {
    return block < entries_.size() && entries_[block].plain != nullptr ? &entries_[block] : nullptr;
  }
  /// Translates a block that has no code yet.
  virtual const Entry& translate(std::uint32_t block) = 0;
  /// Executes the code of an entry up to the hart's limit. If the hart reaches its limit, continues with the hart in
  /// HostState::next. The result is valid until the next translation.
  virtual RunEnd run(Execution& execution, const std::uint8_t* code) = 0;
  /// Returns the exit with this number. The result is valid until the next translation.
  virtual const Exit& exit(std::uint64_t number) const = 0;
  /// Makes the patch point of the last run's exit lead to the code of `block` (block chaining). The last run must have
  /// ended before `block`. `stalled` is true if the block's first instruction stalls after a load.
  virtual void chain_last_exit(const Block& block, const Entry& entry, bool stalled) = 0;
  /// Returns how often regions were dropped. A resume point from before the last drop may be invalid.
  virtual std::uint64_t times_dropped() const = 0;
  /// Returns the number of instructions translated since construction.
  virtual std::uint64_t translated() const = 0;

 protected:
  std::vector<Entry> entries_;  // indexed by block number
};

/// Returns true if this build contains the translator and the host's processor has the required instructions.
bool can_translate();

/// Returns true if at least one form of this operation can be translated.
bool has_translation(Op op);

/// Writes host code for an instruction. Returns false without effect if the interpreter must execute this form of the
/// instruction.
using Lowering = bool (*)(Assembler&, const Instruction*);

/// Returns the lowering of an operation, or null if the operation cannot be translated.
Lowering lowering_of(Op op);

/// Returns null if translation is not possible on this host or for the memories of `execution`.
std::unique_ptr<Translator> make_translator(const BlockCache& blocks, const Execution& execution,
                                            const Options& options);

}  // namespace mebots::soc::translate
