// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

namespace mebots::soc {

/// SoC time since reset in integer picoseconds (up to 106 days).
using Picoseconds = std::int64_t;
inline constexpr Picoseconds kNever = std::numeric_limits<Picoseconds>::max();
inline constexpr Picoseconds kPsPerNs = 1000;
inline constexpr double kPsPerS = 1e12;
/// Latest end of a step, in nanoseconds since the start. Events are planned at most two days later, which still fits.
inline constexpr std::int64_t kLongestNs = 9'000'000 * std::int64_t{1'000'000'000};

}  // namespace mebots::soc
