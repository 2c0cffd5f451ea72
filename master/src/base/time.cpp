// SPDX-License-Identifier: Apache-2.0
#include "base/time.hpp"

#include <cmath>
#include <limits>

namespace mebots::master {

std::optional<std::int64_t> to_nanoseconds(double seconds) {
  if (!std::isfinite(seconds) || std::abs(seconds) > kLongestTimeS) return std::nullopt;
  const double scaled = seconds * 1e9;
  const double whole = std::round(scaled);
  // Reading the decimal and multiplying by 1e9 each round once: two units in the last place at most.
  const double rounding = 2 * std::numeric_limits<double>::epsilon() * std::abs(scaled);
  if (std::abs(scaled - whole) > rounding + 1e-9) return std::nullopt;
  return static_cast<std::int64_t>(whole);
}

double to_seconds(std::int64_t time_ns) {
  // Below 2^53 ns both numbers are exact, so one division rounds once, whole seconds included.
  constexpr std::int64_t kExact_ns = std::int64_t{1} << 53;
  if (time_ns < kExact_ns && time_ns > -kExact_ns) return static_cast<double>(time_ns) / 1e9;
  const auto whole_s = time_ns / kNanosecondsPerSecond;
  if (time_ns % kNanosecondsPerSecond == 0) return static_cast<double>(whole_s);
  return static_cast<double>(time_ns) / 1e9;
}

}  // namespace mebots::master
