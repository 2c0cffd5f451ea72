// SPDX-License-Identifier: Apache-2.0
//
// How a hart runs that is watched: as it runs otherwise, with a pause behind every instruction.
#include "hart/hart.hpp"
#include "hart/observer.hpp"
#include "mebots/assert.hpp"

namespace mebots::soc {
void Hart::observe(Observer* observer) {
  observer_ = observer;
  observer_knows_of_sleep_ = observer != nullptr && sleeping_;
  flow_ = observer == nullptr ? nullptr : observer->flow();
  decoded_->note_flow(flow_);
  drop_resume_point();
}

/// Translated code does not serve an observer who wants to be asked, nor one whose steps it does not note.
bool Hart::may_translate(const Block& block, std::uint32_t stall) const {
  if (!translation_on_) return false;
  if (observer_ != nullptr && (flow_ == nullptr || flow_ != decoded_->flow)) return false;
  return decoded_->flow == nullptr || std::uint64_t{block.fetch_bound} + stall < FlowNotes::kLongestRun;
}

/// Whether an observer for whom this code is quiet must be told of the instruction.
bool Hart::is_told(const Instruction* at, const QuietCode& quiet) {
  if (!quiet.holds(at->pc) || !quiet.holds(at[1].pc) || at[1].op == Op::loop_end) return true;
  if (is_branch(at->op)) return !quiet.holds(static_cast<std::uint32_t>(at->imm));
  if (at->op == Op::jal) return at->rd != 32 || !quiet.holds(static_cast<std::uint32_t>(at->imm));
  return at->op == Op::jalr || at->op == Op::mret;
}

/// The first instruction from `at` on, before `stop` and in the block, of which the observer must be told; else where
/// that ends.
const Instruction* Hart::next_told(const Instruction* at, const Instruction* stop) const {
  const auto quiet = observer_->quiet();
  while (at != stop && !is_block_end(at->op) && !is_told(at, quiet)) ++at;
  return at;
}

/// What the instruction at `pc` is about to do.
Retired Hart::foresee(std::uint32_t pc) const {
  Retired retired;
  std::uint32_t address = 0;
  retired.pc = pc;
  BlockCache::fetch(memory_, pc, retired.word, address);
  retired.decoded = decode(retired.word);
  retired.access = access_of(retired.decoded, *this);
  if (retired.access.store) retired.stored = execution_.x[retired.decoded.rs2];
  return retired;
}

void Hart::step_observed() {
  const auto retired = foresee(execution_.pc);
  const auto instructions = execution_.counters.instructions;
  step();
  if (execution_.counters.instructions != instructions) observer_->retired(*this, retired);
}

/// A block, or only its first instruction, wherever a hart without an observer would decide so. With a strict limit the
/// observer may want the run to end behind any instruction of which it is told, so those run alone. It has been asked
/// before the first instruction.
void Hart::run_block_observed(const Block& block, std::uint32_t stall, std::uint64_t limit, bool alone) {
  alone = alone || (wants_all() && !has_loose_limit() && is_told(cache_.instructions(block), observer_->quiet()));
  if (alone || !run_whole_block_observed(block, stall, limit)) {
    step_observed();
  }
  note_unsettled();
  if (wants_all()) execution_.link = nullptr;
}

/// False: it might reach the limit, and nothing has happened.
bool Hart::run_whole_block_observed(const Block& block, std::uint32_t stall, std::uint64_t limit) {
  if (!cache_.is_present(block) || unsettled_ != 0) return fetch_and_execute(block, stall, limit);
  const auto bound = std::uint64_t{block.last_start_bound} + stall;
  if (execution_.counters.cycles + (bound & bound_mask_) >= limit) return false;
  execute_observed(cache_.instructions(block), 0, stall, nullptr);
  return true;
}

/// As `execute`.
void Hart::execute_observed(const Instruction* first, std::uint32_t extra_cycles, std::uint32_t stall,
                            const Instruction* slow_load) {
  execution_.begin_block(extra_cycles, stall, slow_load);
  run_until_observed(first, nullptr);
  execution_.finish_block();
}

/// As `run_until`, but for what need not be told. While the observer looks, counters and pc are those behind the
/// instruction; for the block they are those of its start.
const Instruction* Hart::run_until_observed(const Instruction* at, const Instruction* stop) {
  auto& e = execution_;
  while (at != nullptr && at != stop) {
    if (const auto* told = next_told(at, stop); told != at) {
      at = run_until(at, told);
      continue;
    }
    const auto retired = foresee(at->pc);
    const auto* next = run_until(at, at + 1);
    if (next != nullptr) e.pc = next->pc;
    const bool has_retired = e.exit->index > at->index;
    if (!has_retired) return nullptr;
    const auto at_start = execution_.counters;
    execution_.count_up_to(*e.exit);
    observer_->retired(*this, retired);
    if (next != nullptr) observer_->before(*this);
    execution_.counters = at_start;
    at = next;
  }
  return at;
}

}  // namespace mebots::soc
