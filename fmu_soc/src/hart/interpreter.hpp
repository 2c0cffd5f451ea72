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

/// Up to where a core runs: every instruction starts before active cycle `end`. With a loose limit, a block that starts
/// before it runs to its end.
class RunLimit {
 public:
  explicit RunLimit(bool loose) : counted_(loose ? 0 : ~std::uint64_t{0}) {}

  bool is_loose() const { return counted_ == 0; }
  void set_end(std::uint64_t cycle) { end_ = std::min(cycle, kLongest); }
  bool reached_at(std::uint64_t cycle) const { return cycle >= end_; }
  std::uint64_t cycles_from(std::uint64_t cycle) const { return end_ - cycle; }
  /// True if a block may begin in `cycle` whose last instruction starts at most `bound` cycles later.
  bool admits(std::uint64_t cycle, std::uint64_t bound) const { return cycle + (bound & counted_) < end_; }

 private:
  static constexpr std::uint64_t kLongest = std::uint64_t{1} << 62;  // more than any core will see

  std::uint64_t end_ = 0;
  std::uint64_t counted_;  // the bits of a bound that count
};

/// Who takes the place of the interpreter on its way through a block, to look at what it does there.
class BlockWalk {
 public:
  BlockWalk() = default;
  BlockWalk(const BlockWalk&) = delete;
  BlockWalk& operator=(const BlockWalk&) = delete;

  /// As Interpreter::run_until; a null `stop` is no instruction of the block.
  virtual const Instruction* walk(const Instruction* at, const Instruction* stop) = 0;

 protected:
  ~BlockWalk() = default;
};

/// Runs decoded blocks by the handlers of their instructions: one instruction, a block, or what is left of one. Where
/// lines of a block are absent from the instruction cache, they come one by one, each when it is reached.
class Interpreter {
 public:
  Interpreter(Execution& execution, const Memory& memory, BlockCache& blocks, Fetch& fetch, const RunLimit& limit)
      : execution_(execution), memory_(memory), blocks_(blocks), fetch_(fetch), limit_(limit) {}

  /// Who goes through blocks in its place from now on; null = itself.
  void set_walk(BlockWalk* walk) { walk_ = walk; }

  /// The instruction at the pc alone, decoded with what the pipeline holds. Nobody walks in its place.
  void step();
  /// From the start of a block, whose first instruction waits for a load for `stall` cycles, to the limit, or to where
  /// the block is left. Nobody walks in its place.
  void run_to_limit(const Block& block, std::uint32_t stall);
  /// Likewise, from where the limit cut a block last. False: the core stands elsewhere, and nothing has happened.
  bool go_on_to_limit();
  /// A block, whose first instruction waits for a load for `stall` cycles. False: it might reach the limit, and nothing
  /// has happened.
  bool run(const Block& block, std::uint32_t stall);
  /// Likewise, and behind it what follows by links without anything to decide. Nobody walks in its place.
  bool run_on(const Block& block, std::uint32_t stall, const Csrs& csrs);
  /// From inside a block that translated code has left, which has waited for `wait_cycles`. `fetches`: lines of what
  /// comes may be absent.
  void resume(const Instruction* at, std::uint32_t wait_cycles, std::uint32_t stall, const Instruction* slow_load,
              bool fetches);

  /// From one instruction of a block on up to before another, which comes back then; null when the block was left.
  const Instruction* run_until(const Instruction* at, const Instruction* stop);

 private:
  void execute(const Instruction* first, std::uint32_t extra_cycles, std::uint32_t stall, const Instruction* slow_load);
  bool run_fetching(const Block& block, std::uint32_t stall);
  void execute_fetching(const Instruction* at);
  void run_one_by_one(const Instruction* at);
  void cut_at(const Instruction* at);

  /// Where the limit cut a block. The slots behind it hold as long as blocks do, and behind what came then.
  struct Cut {
    const Instruction* at = nullptr;  // null = nowhere
    std::uint64_t generation = 0;     // of blocks
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

inline bool Interpreter::run_on(const Block& block, std::uint32_t stall, const Csrs& csrs) {
  MEBOTS_ASSERT(walk_ == nullptr, "an observer walks instead");
  if (!run(block, stall)) return false;
  // Only the limit and the lines are to be checked.
  auto& e = execution_;
  const auto& blocks = blocks_;
  const auto& limit = limit_;
  while (e.link != nullptr && *e.link != 0 && e.leave == Leave::normal && !csrs.interrupt_ready() &&
         !blocks.is_stale()) {
    const auto& next = blocks.block(*e.link);
    if (next.pc != e.pc || !blocks.is_present(next)) break;
    if (blocks.delays_jump(next, e.pipeline.two_before, e.pipeline.before)) break;
    const auto cycles = e.counters.cycles + (e.jumped && next.unaligned ? kUnalignedTargetExtra : 0U);
    const auto next_stall = next.stall_behind(e.pipeline.before);
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
