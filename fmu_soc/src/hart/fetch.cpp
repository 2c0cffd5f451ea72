// SPDX-License-Identifier: Apache-2.0
//
// How code comes through the instruction cache. An instruction waits for its lines when it is reached, never before: so
// a core that was stopped anywhere has made the same refills in the same cycles. Blocks whose lines are all there run
// as if there were no cache; of the others translated code runs the front, if that is there, and the rest comes here.
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
  if (fetched_ == &cache) return;
  fetched_ = &cache;
  decoded_->drop_translations();
  if (cache_.fetched() != &cache) cache.cover(memory_);
  cache_.fetch_through(cache);
}

void Hart::flush_fetched() {
  if (fetched_ == nullptr) return;
  fetched_->flush();
}

/// Cycles that the instruction waits for its lines when it is reached in active cycle `cycle`.
std::uint32_t Hart::fetch(const Instruction* at, std::uint64_t cycle) {
  std::uint32_t wait = 0;
  for (auto line = fetched_->line_of(at->pc); line <= fetched_->line_of(at[1].pc - 1); ++line) {
    wait += fetched_->fetch(line, cycle + wait + execution_.host.tick_offset);
  }
  execution_.counters.fetch_cycles += wait;
  return wait;
}

/// The first instruction of the block behind `at` that may have to wait, or the end of the block.
const Instruction* Hart::next_to_fetch(const Instruction* at) const {
  const bool all = fetch_unsettled();  // a line that is here may not have arrived yet
  auto line = fetched_->line_of(at[1].pc - 1);
  for (++at; !is_block_end(at->op); ++at) {
    const auto last = fetched_->line_of(at[1].pc - 1);
    if (last == line) continue;
    if (all || !fetched_->holds(last) || !fetched_->holds(fetched_->line_of(at->pc))) return at;
    line = last;
  }
  return at;
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
  const bool unsettled = fetch_unsettled();
  std::uint32_t missing = 0;  // at most: what is brought can drive out what comes behind it
  for (std::uint32_t i = 0; i < block.line_count; ++i) {
    if (missing != 0 || unsettled || block.lines[i] == 0) ++missing;
  }
  const auto bound = std::uint64_t{block.last_start_bound} + stall + std::uint64_t{missing} * fetched_->refill_cycles();
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
    begin_block(fetch(first, execution_.counters.cycles), stall, nullptr);
    execute_fetching(first);
  }
  return true;
}

/// Whether all lines of a block from this instruction on are in the cache.
bool Hart::is_present(const Instruction* at) const {
  if (fetched_ == nullptr) return true;
  const auto first = fetched_->line_of(at->pc);
  while (!is_block_end(at->op)) ++at;
  for (auto line = first; line <= fetched_->line_of(at->pc - 1); ++line) {
    if (!fetched_->holds(line)) return false;
  }
  return true;
}

/// Goes on in a block that translated code has left, of which what comes may be absent.
void Hart::resume_fetching(const Instruction* at, std::uint32_t wait_cycles, std::uint32_t stall,
                           const Instruction* slow_load) {
  begin_block(wait_cycles, stall, slow_load);
  execution_.extra_cycles += fetch(at, cycle_of(at));
  execute_fetching(at);
  unsettled_ = fetch_unsettled() ? kAbsent : 0;
}

/// As `execute` of an instruction that is fetched, but lines come one by one: it goes on to the next instruction that
/// needs one, and waits there.
void Hart::execute_fetching(const Instruction* at) {
  while (at != nullptr) {
    const auto* stop = next_to_fetch(at);
    at = observer_ != nullptr ? run_until_observed(at, stop) : run_until(at, stop);
    if (at != nullptr) execution_.extra_cycles += fetch(at, cycle_of(at) + hidden_in(execution_, at));
  }
  finish_block();
}

}  // namespace mebots::soc
