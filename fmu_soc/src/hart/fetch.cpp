// SPDX-License-Identifier: Apache-2.0
#include "hart/fetch.hpp"

#include "mebots/assert.hpp"

namespace mebots::soc {

void Fetch::flush() {
  if (cache_ != nullptr) cache_->flush();
}

std::uint32_t Fetch::bring(const Instruction* at, std::uint64_t cycle) {
  MEBOTS_ASSERT(is_cached() && !is_block_end(at->op));
  std::uint32_t wait = 0;
  for (auto line = cache_->line_of(at->pc); line <= cache_->line_of(at[1].pc - 1); ++line) {
    wait += cache_->fetch(line, cycle + wait + execution_.host.tick_offset);
  }
  execution_.counters.fetch_cycles += wait;
  return wait;
}

const Instruction* Fetch::next_to_wait(const Instruction* at) const {
  MEBOTS_ASSERT(is_cached() && !is_block_end(at->op));
  auto line = cache_->line_of(at[1].pc - 1);
  for (++at; !is_block_end(at->op); ++at) {
    const auto last = cache_->line_of(at[1].pc - 1);
    if (last == line) continue;
    if (!cache_->has_arrived(last) || !cache_->has_arrived(cache_->line_of(at->pc))) return at;
    line = last;
  }
  return at;
}

bool Fetch::is_present(const Instruction* at) const {
  if (cache_ == nullptr) return true;
  const auto first = cache_->line_of(at->pc);
  while (!is_block_end(at->op)) ++at;
  for (auto line = first; line <= cache_->line_of(at->pc - 1); ++line) {
    if (!cache_->has_arrived(line)) return false;
  }
  return true;
}

}  // namespace mebots::soc
