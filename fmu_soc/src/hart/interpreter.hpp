// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/block_cache.hpp"
#include "hart/csrs.hpp"
#include "hart/execution.hpp"
#include "hart/fetch.hpp"
#include "mebots/assert.hpp"

#include <algorithm>
#include <cstdint>

namespace mebots::soc {

/// The limit of a run: every instruction starts before active cycle `end`. If the limit is loose, a block that starts
/// before `end` is executed to its end.
class RunLimit {
 public:
  explicit RunLimit(bool loose) : counted_(loose ? 0 : ~std::uint64_t{0}) {}

  bool is_loose() const { return counted_ == 0; }
  void set_end(std::uint64_t cycle) { end_ = std::min(cycle, kLongest); }
  bool reached_at(std::uint64_t cycle) const { return cycle >= end_; }
  std::uint64_t cycles_from(std::uint64_t cycle) const { return end_ - cycle; }
  /// Returns true if a block may start in `cycle`. `bound` is the largest number of cycles from the start of the block
  /// to the start of its last instruction.
  bool admits(std::uint64_t cycle, std::uint64_t bound) const { return cycle + (bound & counted_) < end_; }

 private:
  static constexpr std::uint64_t kLongest = std::uint64_t{1} << 62;  // more cycles than any run can take

  std::uint64_t end_ = 0;
  std::uint64_t counted_;  // a mask: 0 if the limit is loose, otherwise all bits
};

/// Replaces the interpreter's loop over the instructions of a block, to observe each instruction.
class BlockWalk {
 public:
  BlockWalk() = default;
  BlockWalk(const BlockWalk&) = delete;
  BlockWalk& operator=(const BlockWalk&) = delete;

  /// Executes instructions like Interpreter::run_until(). If `stop` is null, executes the block to its end.
  virtual const Instruction* walk(const Instruction* at, const Instruction* stop) = 0;

 protected:
  ~BlockWalk() = default;
};

/// Executes decoded code by calling the handlers of its instructions: a single instruction, a block, or the rest of a
/// block.
class Interpreter {
 public:
  Interpreter(Execution& execution, const Memory& memory, BlockCache& blocks, Fetch& fetch, const RunLimit& limit)
      : execution_(execution), memory_(memory), blocks_(blocks), fetch_(fetch), limit_(limit) {}

  /// Sets the replacement for the loop over the instructions of a block; null restores the interpreter's loop.
  void set_walk(BlockWalk* walk) { walk_ = walk; }

  /// Executes only the instruction at the pc, decoded for the present state of the pipeline. Does not use the
  /// BlockWalk.
  void step();
  /// Executes a block to the limit or to the block's end. The first instruction stalls for `stall` cycles after a load.
  /// Must not be called while set_walk() has replaced the loop over the instructions.
  void run_to_limit(const Block& block, std::uint32_t stall);
  /// Continues the block that the last limit has interrupted, to the new limit. Returns false without effect if the
  /// core is no longer at the place of the interruption.
  bool resume_to_limit();
  /// Executes a block whose first instruction stalls for `stall` cycles. Returns false without effect if the block
  /// might reach the limit.
  bool run(const Block& block, std::uint32_t stall);
  /// Executes a block and then the blocks linked to it, until a condition such as an interrupt requires the caller's
  /// attention. Returns false without effect if the first block might reach the limit. Must not be called while
  /// set_walk() has replaced the loop over the instructions.
  bool run_linked(const Block& block, std::uint32_t stall, const Csrs& csrs);
  /// Resumes a block at the instruction `at`, where translated code has left it. `wait_cycles` is the number of cycles
  /// that translated code waited in the block. `fetches` must be true if cache lines may be absent.
  void resume(const Instruction* at, std::uint32_t wait_cycles, std::uint32_t stall, const Instruction* slow_load,
              bool fetches);

  /// Executes a block from `at` up to, but not including, `stop`. Returns `stop`, or null if execution has left the
  /// block.
  const Instruction* run_until(const Instruction* at, const Instruction* stop);

 private:
  void execute(const Instruction* first, std::uint32_t extra_cycles, std::uint32_t stall, const Instruction* slow_load);
  bool run_fetching(const Block& block, std::uint32_t stall);
  void execute_fetching(const Instruction* at);
  void run_one_by_one(const Instruction* at);
  void cut_at(const Instruction* at);

  /// The instruction before which a limit interrupted a block. The pointer is valid as long as the blocks and the
  /// pipeline do not change.
  struct Cut {
    const Instruction* at = nullptr;  // null = no block was interrupted
    std::uint64_t generation = 0;     // BlockCache::generation() at the interruption
    Pipeline pipeline;
  };

  Execution& execution_;
  const Memory& memory_;
  BlockCache& blocks_;
  Fetch& fetch_;
  const RunLimit& limit_;
  BlockWalk* walk_ = nullptr;
  Cut cut_;
};

inline void Interpreter::execute(const Instruction* first, std::uint32_t extra_cycles, std::uint32_t stall,
                                 const Instruction* slow_load) {
  execution_.begin_block(extra_cycles, stall, slow_load);
  if (walk_ != nullptr) [[unlikely]] {
    walk_->walk(first, nullptr);
  } else {
    for (const auto* at = first; at != nullptr;) at = at->run(execution_, at);
  }
  execution_.finish_block();
}

inline bool Interpreter::run(const Block& block, std::uint32_t stall) {
  if (!blocks_.is_present(block)) [[unlikely]]
    return run_fetching(block, stall);
  if (!limit_.admits(execution_.counters.cycles, std::uint64_t{block.last_start_bound} + stall)) return false;
  execute(blocks_.instructions(block), 0, stall, nullptr);
  return true;
}

inline bool Interpreter::run_linked(const Block& block, std::uint32_t stall, const Csrs& csrs) {
  MEBOTS_ASSERT(walk_ == nullptr, "with an observer, run() is used");
  if (!run(block, stall)) return false;
  // Between linked blocks, check only what may change in a block: the limit, interrupts, PMP, code and cache lines.
  auto& e = execution_;
  const auto& blocks = blocks_;
  const auto& limit = limit_;
  while (e.link != nullptr && *e.link != 0 && e.leave == Leave::normal && !csrs.interrupt_ready() &&
         !csrs.is_guarded() && !blocks.is_stale()) {
    const auto& next = blocks.block(*e.link);
    if (next.pc != e.pc || !blocks.is_present(next)) break;
    if (blocks.delays_jump(next, e.pipeline.two_before, e.pipeline.before)) break;
    const auto cycles = e.counters.cycles + (e.jumped && next.unaligned ? kUnalignedTargetExtra : 0U);
    const auto next_stall = next.stall_after(e.pipeline.before);
    if (!limit.admits(cycles, std::uint64_t{next.last_start_bound} + next_stall)) break;
    e.counters.cycles = cycles;
    e.jumped = false;
    e.link = nullptr;
    e.begin_block(0, next_stall, nullptr);
    for (const auto* at = blocks.instructions(next); at != nullptr;) at = at->run(e, at);
    e.finish_block();
  }
  return true;
}

}  // namespace mebots::soc
