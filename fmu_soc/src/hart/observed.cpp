// SPDX-License-Identifier: Apache-2.0
//
// How a hart runs that is watched: as it runs otherwise, with a pause behind every instruction.
#include "hart/hart.hpp"
#include "hart/observer.hpp"

namespace mebots::soc {

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

/// A block, or only its first instruction, wherever a hart without an observer would decide so. The observer has been
/// asked before the first instruction.
void Hart::run_block_observed(const Block& block, std::uint32_t stall, std::uint64_t limit, bool alone) {
  if (alone) {
    const auto retired = foresee(execution_.pc);
    const auto instructions = execution_.counters.instructions;
    step();
    if (execution_.counters.instructions != instructions) observer_->retired(*this, retired);
  } else if (!cache_.is_present(block) || unsettled_ != 0) {
    fetch_and_execute(block, stall, limit);
  } else {
    execute_observed(cache_.instructions(block), stall);
  }
  unsettled_ = fetch_unsettled() ? kAbsent : 0;
  execution_.link = nullptr;
}

/// As `execute`.
void Hart::execute_observed(const Instruction* first, std::uint32_t stall) {
  begin_block(0, stall, nullptr);
  run_until_observed(first, nullptr);
  finish_block();
}

/// As `run_until`. While the observer looks, counters and pc are those behind the instruction; for the block they are
/// those of its start.
const Instruction* Hart::run_until_observed(const Instruction* at, const Instruction* stop) {
  auto& e = execution_;
  while (at != nullptr && at != stop) {
    const auto retired = foresee(at->pc);
    const auto* next = run_until(at, at + 1);
    if (next != nullptr) e.pc = next->pc;
    const bool has_retired = e.exit->index > at->index;
    if (!has_retired) return nullptr;
    const auto at_start = execution_.counters;
    count_up_to(*e.exit);
    observer_->retired(*this, retired);
    if (next != nullptr) observer_->before(*this);
    execution_.counters = at_start;
    at = next;
  }
  return at;
}

}  // namespace mebots::soc
