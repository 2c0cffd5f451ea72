// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

namespace mebots::world {

/// Marks the time before the first period. period_at() does not return this value.
inline constexpr std::int64_t kNoPeriod = std::numeric_limits<std::int64_t>::min();

/// Returns the number of the period that contains a time. Period 0 starts at time 0. Earlier periods have negative
/// numbers.
constexpr std::int64_t period_at(std::int64_t time_ns, std::int64_t period_ns) {
  const std::int64_t towards_zero = time_ns / period_ns;
  return time_ns % period_ns < 0 ? towards_zero - 1 : towards_zero;
}

}  // namespace mebots::world
