// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

namespace mebots::soc {

/// SoC time in whole picoseconds since reset (106 days fit).
using Picoseconds = std::int64_t;
inline constexpr Picoseconds kNever = std::numeric_limits<Picoseconds>::max();
inline constexpr Picoseconds kPsPerNs = 1000;
inline constexpr double kPsPerS = 1e12;
/// A step may go no further from the start: what is planned from there on, two days ahead at most, still fits.
inline constexpr std::int64_t kLongestNs = 9'000'000 * std::int64_t{1'000'000'000};

}  // namespace mebots::soc
