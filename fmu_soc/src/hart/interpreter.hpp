// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/block_cache.hpp"
#include "hart/csrs.hpp"
#include "hart/execution.hpp"
#include "hart/fetch.hpp"
#include "hart/run_limit.hpp"

#include <cstdint>

namespace mebots::soc {

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
  /// A block, whose first instruction waits for a load for `stall` cycles. False: it might reach the limit, and nothing
  /// has happened.
  bool run(const Block& block, std::uint32_t stall);
  /// Likewise, and behind it what follows by links without anything to decide.
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

  Execution& execution_;
  const Memory& memory_;
  BlockCache& blocks_;
  Fetch& fetch_;
  const RunLimit& limit_;
  BlockWalk* walk_ = nullptr;
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

}  // namespace mebots::soc
