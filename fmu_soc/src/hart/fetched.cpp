// SPDX-License-Identifier: Apache-2.0
//
// How a hart runs code of which lines are absent from the instruction cache. Blocks whose lines are all there run as if
// there were no cache. Of the others translated code runs the front, if that is there, and the rest comes here.
#include "hart/hart.hpp"

namespace mebots::soc {
namespace {

/// In place of an instruction that must wait.
const Instruction* stop_here(Execution& e, const Instruction* at) {
  e.exit = at;
  e.waits_at = at;
  return nullptr;
}

/// A jump hides some of its cycles behind a load across two words, which has given them back already.
std::uint32_t hidden_in(const Execution& e, const Instruction* jump) {
  const bool hides = jump->index != 0 && is_jump(jump->op) && e.slow_load == jump - 1 && jump->rs1 != jump[-1].rd;
  return hides ? jump[1].cycles_before - jump->cycles_before - 1U : 0U;
}

}  // namespace

void Hart::fetch_through(InstructionCache& cache) {
  if (fetch_.cache() == &cache) return;
  fetch_.go_through(cache);
  decoded_->drop_translations();
  if (cache_.fetched() != &cache) cache.cover(memory_);
  cache_.fetch_through(cache);
}

/// From one instruction of a block on up to before another, which comes back then; null when the block was left.
const Instruction* Hart::run_until(const Instruction* at, const Instruction* stop) {
  auto& e = execution_;
  e.waits_at = nullptr;
  const bool to_end = is_block_end(stop->op);
  const auto handler = to_end ? nullptr : cache_.exchange(stop, stop_here);
  while (at != nullptr) at = at->run(e, at);
  if (!to_end) cache_.exchange(stop, handler);
  return e.waits_at;
}

/// Runs a block of which lines are absent. False: it might reach the limit, and nothing has happened.
bool Hart::fetch_and_execute(const Block& block, std::uint32_t stall, std::uint64_t limit) {
  const bool unsettled = fetch_.is_unsettled();
  std::uint32_t missing = 0;  // at most: what is brought can drive out what comes behind it
  for (std::uint32_t i = 0; i < block.line_count; ++i) {
    if (missing != 0 || unsettled || block.lines[i] == 0) ++missing;
  }
  const auto bound =
      std::uint64_t{block.last_start_bound} + stall + std::uint64_t{missing} * fetch_.cache()->refill_cycles();
  if (execution_.counters.cycles + (bound & bound_mask_) >= limit) return false;
  const auto* first = cache_.instructions(block);
  if (missing == 0) {
    if (observer_ != nullptr) {
      execute_observed(first, 0, stall, nullptr);
    } else {
      execute(first, 0, stall);
    }
  } else {
    // The first instruction is fetched before it stalls for a load, as all others are.
    execution_.begin_block(fetch_.bring(first, execution_.counters.cycles), stall, nullptr);
    execute_fetching(first);
  }
  return true;
}

/// Goes on in a block that translated code has left, of which what comes may be absent.
void Hart::resume_fetching(const Instruction* at, std::uint32_t wait_cycles, std::uint32_t stall,
                           const Instruction* slow_load) {
  execution_.begin_block(wait_cycles, stall, slow_load);
  execution_.extra_cycles += fetch_.bring(at, execution_.cycle_of(at));
  execute_fetching(at);
  unsettled_ = fetch_.is_unsettled() ? kAbsent : 0;
}

/// As `execute` of an instruction that is fetched, but lines come one by one. It goes on to the next instruction that
/// needs one, and waits there.
void Hart::execute_fetching(const Instruction* at) {
  while (at != nullptr) {
    const auto* stop = fetch_.next_to_wait(at);
    at = observer_ != nullptr ? run_until_observed(at, stop) : run_until(at, stop);
    if (at != nullptr) execution_.extra_cycles += fetch_.bring(at, execution_.cycle_of(at) + hidden_in(execution_, at));
  }
  execution_.finish_block();
}

}  // namespace mebots::soc
