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

}  // namespace mebots::soc
