// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

namespace mebots::soc {

/// A time in picoseconds since the chip's reset. The largest time is 106 days.
using Picoseconds = std::int64_t;
inline constexpr Picoseconds kNever = std::numeric_limits<Picoseconds>::max();
inline constexpr Picoseconds kPsPerNs = 1000;
inline constexpr double kPsPerS = 1e12;
/// The latest end of a communication step, in nanoseconds since the start. An event up to two days later still fits in
/// Picoseconds.
inline constexpr std::int64_t kLongestNs = 9'000'000 * std::int64_t{1'000'000'000};

}  // namespace mebots::soc
