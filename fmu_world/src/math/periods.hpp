// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

namespace mebots::world {

/// In place of a period's number where there was none yet: no time lies in it.
inline constexpr std::int64_t kNoPeriod = std::numeric_limits<std::int64_t>::min();

/// Number of the period that a time lies in. Period 0 begins at time 0; those before it are negative, and none is
/// longer than another.
constexpr std::int64_t period_at(std::int64_t time_ns, std::int64_t period_ns) {
  const std::int64_t towards_zero = time_ns / period_ns;
  return time_ns % period_ns < 0 ? towards_zero - 1 : towards_zero;
}

}  // namespace mebots::world
