// SPDX-License-Identifier: Apache-2.0
#include "engine/algorithm/slave_steps.hpp"

#include "base/time.hpp"

#include <cmath>
#include <limits>

namespace mebots::master {
namespace {

constexpr std::int64_t kShortestPartNs = 1000;

/// Returns the length of the next part to try. If the FMU reported the time of its last successful step, the part ends
/// at this time, rounded down to nanoseconds. Otherwise, returns half the length of the discarded part.
std::int64_t shorter_part(const StepResult& result, std::int64_t at_ns, std::int64_t part_ns) {
  if (result.last_successful_s) {
    const double reached_ns = *result.last_successful_s * 1e9;
    // Rounding may place the reported time slightly below a whole nanosecond.
    const double roundings_ns = 4 * std::numeric_limits<double>::epsilon() * std::abs(reached_ns);
    const double length_ns = std::floor(reached_ns + roundings_ns) - static_cast<double>(at_ns);
    if (length_ns >= kShortestPartNs && length_ns < static_cast<double>(part_ns)) {
      return static_cast<std::int64_t>(length_ns);
    }
  }
  return part_ns / 2;
}

}  // namespace

StepResult step_in_parts(Slave& slave, std::int64_t start_ns, std::int64_t duration_ns,
                         const std::atomic<bool>& cancel) {
  const auto end_ns = start_ns + duration_ns;
  auto at_ns = start_ns;
  auto part_ns = duration_ns;
  while (true) {
    const auto state = slave.save_state();
    auto result = slave.step(at_ns, part_ns);
    if (result.pending) result = slave.finish_step(cancel);
    if (result.done) {
      at_ns += part_ns;
      if (at_ns == end_ns) return result;
      part_ns = end_ns - at_ns;
      continue;
    }
    if (result.terminated || result.cancelled) return result;
    part_ns = shorter_part(result, at_ns, part_ns);
    if (part_ns < kShortestPartNs) return result;
    slave.restore_state(*state);
  }
}

}  // namespace mebots::master
