// SPDX-License-Identifier: Apache-2.0
#include "hart/interpreter.hpp"

#include "hart/csr_numbers.hpp"
#include "mebots/assert.hpp"

namespace mebots::soc {
namespace {

/// Handler that stops execution before an instruction. It temporarily replaces the instruction's handler.
const Instruction* stop_here(Execution& e, const Instruction* at) {
  e.exit = at;
  e.waits_at = at;
  return nullptr;
}

/// Returns how many cycles of a jump overlap with a misaligned load before it. This number was already subtracted from
/// the cycles of the load.
std::uint32_t overlapped_cycles(const Execution& e, const Instruction* jump) {
  const bool hides = jump->index != 0 && e.slow_load == jump - 1 &&
                     overlaps_slow(executed(jump[-1], true), {jump->op, jump->rd, jump->rs1});
  return hides ? jump[1].cycles_before - jump->cycles_before - 1U : 0U;
}

}  // namespace

void Interpreter::step() {
  auto& e = execution_;
  const auto* first = blocks_.single(e.pc, e.pipeline.two_before, e.pipeline.before);
  if (first == nullptr) {
    std::uint32_t word = 0;
    BlockCache::fetch(memory_, e.pc, word, e.trap_value);
    e.trap_cause = cause::kFetchAccess;
    e.leave = Leave::trap;
    return;
  }
  e.cut_pc = first[1].pc;
  e.begin_block(fetch_.is_cached() ? fetch_.fetch_lines(first, e.counters.cycles) : 0, 0, nullptr);
  for (const auto* at = first; at != nullptr;) at = at->run(e, at);
  e.finish_block();
  e.link = nullptr;
}

void Interpreter::run_to_limit(const Block& block, std::uint32_t stall) {
  MEBOTS_ASSERT(!limit_.is_loose() && walk_ == nullptr);
  const auto* first = blocks_.instructions(block);
  execution_.begin_block(fetch_.is_cached() ? fetch_.fetch_lines(first, execution_.counters.cycles) : 0, stall,
                         nullptr);
  run_one_by_one(first);
}

bool Interpreter::resume_to_limit() {
  auto& e = execution_;
  const auto* at = cut_.at;
  const bool is_here = at != nullptr && cut_.generation == blocks_.generation() && at->pc == e.pc;
  if (!is_here || cut_.pipeline != e.pipeline) return false;
  e.begin_block_inside(at);
  if (fetch_.is_cached()) e.extra_cycles += fetch_.fetch_lines(at, e.cycle_of(at));
  run_one_by_one(at);
  return true;
}

/// Executes a block one instruction at a time from `at`, whose cache line is present. Each instruction takes the cycles
/// that are known from decoding. Exception: if a jump follows a misaligned load, the overlapping cycles of the jump
/// were already subtracted at the load. The limit may be between these two instructions.
void Interpreter::run_one_by_one(const Instruction* at) {
  MEBOTS_ASSERT(at != nullptr && walk_ == nullptr);
  auto& e = execution_;
  cut_.at = nullptr;
  for (;;) {
    const auto* next = run_until(at, at + 1);
    if (next == nullptr) break;
    const auto hidden = overlapped_cycles(e, next);
    const auto cycle = e.cycle_of(next) + hidden;
    if (limit_.reached_at(cycle)) {
      e.extra_cycles += hidden;
      cut_at(next);
      break;
    }
    if (fetch_.is_cached() && !fetch_.shares_line(at, next)) e.extra_cycles += fetch_.fetch_lines(next, cycle);
    at = next;
  }
  e.finish_block();
  if (cut_.at != nullptr) cut_.pipeline = e.pipeline;
}

/// Stops the core inside a block, before the instruction `at`.
void Interpreter::cut_at(const Instruction* at) {
  MEBOTS_ASSERT(at->index > 0 && !is_block_end(at->op));
  auto& e = execution_;
  e.pc = at->pc;
  e.exit = at;
  e.link = nullptr;
  e.cut_pc = at->pc;
  // After a misaligned load, a jump takes fewer cycles than the decoded block contains. Therefore resume_to_limit()
  // must not continue this block.
  if (e.slow_load == at - 1) return;
  cut_ = {at, blocks_.generation(), {}};
}

void Interpreter::resume(const Instruction* at, std::uint32_t wait_cycles, std::uint32_t stall,
                         const Instruction* slow_load, bool fetches) {
  MEBOTS_ASSERT(!is_block_end(at->op));
  if (!fetches) {
    execute(at, wait_cycles, stall, slow_load);
    return;
  }
  execution_.begin_block(wait_cycles, stall, slow_load);
  execution_.extra_cycles += fetch_.fetch_lines(at, execution_.cycle_of(at));
  execute_fetching(at);
}

const Instruction* Interpreter::run_until(const Instruction* at, const Instruction* stop) {
  MEBOTS_ASSERT(at != nullptr && stop > at, "`stop` follows `at` in the block");
  auto& e = execution_;
  e.waits_at = nullptr;
  const bool to_end = is_block_end(stop->op);
  const auto handler = to_end ? nullptr : blocks_.exchange(stop, stop_here);
  while (at != nullptr) at = at->run(e, at);
  if (!to_end) blocks_.exchange(stop, handler);
  return e.waits_at;
}

/// Executes a block with cache lines that are absent or have not arrived yet.
bool Interpreter::run_fetching(const Block& block, std::uint32_t stall) {
  MEBOTS_ASSERT(fetch_.is_cached());
  std::uint32_t missing = 0;  // upper bound, because a refill may evict lines that the block needs later
  for (std::uint32_t i = 0; i < block.line_count; ++i) {
    if (missing != 0 || block.lines[i] == 0) ++missing;
  }
  const auto wait = std::uint64_t{missing} * fetch_.cache()->refill_cycles();
  if (!limit_.admits(execution_.counters.cycles, block.last_start_bound + stall + wait)) return false;
  const auto* first = blocks_.instructions(block);
  // The cache lines of the first instruction are fetched before this instruction stalls for a load.
  execution_.begin_block(fetch_.fetch_lines(first, execution_.counters.cycles), stall, nullptr);
  execute_fetching(first);
  return true;
}

/// Executes the rest of a block from `at`, whose cache line is present. Each time an instruction needs a line that has
/// not arrived, waits for this line.
void Interpreter::execute_fetching(const Instruction* at) {
  while (at != nullptr) {
    const auto* stop = fetch_.next_to_wait(at);
    at = walk_ != nullptr ? walk_->walk(at, stop) : run_until(at, stop);
    if (at != nullptr)
      execution_.extra_cycles += fetch_.fetch_lines(at, execution_.cycle_of(at) + overlapped_cycles(execution_, at));
  }
  execution_.finish_block();
}

}  // namespace mebots::soc
