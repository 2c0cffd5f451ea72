// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

namespace mebots::master {

/// Simulated time is counted in whole nanoseconds; seconds appear only at the FMI boundary and in files.
inline constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

/// The longest time that is accepted [s]: what 64 bits of nanoseconds hold, rounded down.
inline constexpr double kLongestTimeS = 9.2e9;

/// The nanoseconds that a decimal number of seconds stands for, or nothing when it is not a whole number
/// of them, not finite, or longer than kLongestTimeS. The binary rounding of a decimal fraction
/// (0.1, 0.002) is forgiven, a fraction of a nanosecond is not.
std::optional<std::int64_t> to_nanoseconds(double seconds);

/// Seconds as the double nearest to the exact value (for times below 104 days, and for whole seconds).
double to_seconds(std::int64_t time_ns);

}  // namespace mebots::master
