// SPDX-License-Identifier: Apache-2.0
#include "runs/flow_log.hpp"

#include "mebots/assert.hpp"
#include "runs/observed_run.hpp"

#include <algorithm>

namespace mebots::soc {
namespace {

/// Maximum number of steps that a run can record. An instruction takes at least one cycle and records at most one step.
/// If blocks may run past the limit (loose limit), the last block may end after the run's limit.
constexpr std::size_t kMostSteps = FlowLog::kLongestRun + BlockCache::kMaxBlockLength;
static_assert(FlowLog::kLongestRun >= 2 * Banks::kLongestRun,
              "a run of a round is at most a quantum and the ticks that the core is late");

}  // namespace

std::uint64_t FlowLog::make_room(std::uint64_t cycles) {
  if (decoded_.flow == nullptr) return cycles;
  if (steps_ == nullptr) {
    steps_ = std::make_unique_for_overwrite<Flow[]>(kMostSteps);
    execution_.host.flow = steps_.get();
  }
  return std::min(cycles, kLongestRun);
}

void FlowLog::report(const ObservedRun& observed) {
  auto& e = execution_;
  if (e.host.flow == steps_.get()) return;
  const std::span steps(steps_.get(), e.host.flow);
  MEBOTS_ASSERT(e.host.flow > steps_.get());
  MEBOTS_ASSERT(steps.size() <= kMostSteps);
  e.host.flow = steps_.get();
  if (observed.observer() == nullptr) return;
  make_absolute(steps);
  // During the observer's call, the hart's counters have their values after the last step.
  const auto at_end = e.counters;
  const auto& last = steps.back();
  e.counters.instructions = last.instructions;
  e.counters.cycles = last.cycles;
  e.counters.instruction_fj = last.instruction_fj;
  e.counters.accesses = last.accesses;
  e.counters.far_accesses = last.far_accesses;
  observed.flowed(steps);
  e.counters = at_end;
}

/// Converts the counts that translated code has recorded to the hart's counters.
void FlowLog::make_absolute(std::span<Flow> steps) const {
  const auto& host = execution_.host;
  const auto& counters = execution_.counters;
  const auto instructions = counters.instructions - (host.instructions & 0xffffffffU);
  const auto accesses = counters.accesses - (host.instructions >> 32);
  const auto instruction_fj = counters.instruction_fj - host.instruction_fj;
  const auto* banks = decoded_.banks;
  for (auto& step : steps) {
    // Computes the cycles from the step to the end of the run. The value that the step recorded decreases by one per
    // cycle. If banks are shared, it is an address instead, which increases by one row per cycle. If translated code
    // has left a block before its end, the difference is negative, because the cycles of the block are not counted yet.
    auto left = static_cast<std::int64_t>(step.cycles - host.position);
    if (banks != nullptr) left = -left / static_cast<std::int64_t>(banks->count());
    step.cycles = counters.cycles - static_cast<std::uint64_t>(left);
    step.accesses = accesses + (step.instructions >> 32);
    step.instructions = instructions + (step.instructions & 0xffffffffU);
    step.instruction_fj += instruction_fj;
  }
}

}  // namespace mebots::soc
