// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tool/options.hpp"

namespace mebots::soc::tool {

inline constexpr int kFaultOrLimit = 101;
inline constexpr int kBadInput = 102;

/// Runs a program to its end and reports. Gives the exit code: tohost >> 1 or what the firmware passed to EXIT (low 8
/// bits), or kFaultOrLimit. Throws Error for bad input.
int run(const Options& options);

}  // namespace mebots::soc::tool
