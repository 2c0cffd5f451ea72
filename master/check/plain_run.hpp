// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "child.hpp"

#include <filesystem>

namespace mebots::check {

/// The number of steps of a plain run. If the description states no step size, each step takes kPlainStep_s.
inline constexpr int kPlainSteps = 20;
inline constexpr double kPlainStep_s = 0.01;

/// Runs `instances` instances of a co-simulation FMU for a few steps, in the same way as the master, and reads all
/// scalar Real outputs. The FMU is unpacked in `folder`. Must be called only in a child process.
void run_plainly(const std::filesystem::path& archive, const std::filesystem::path& folder, int instances,
                 double step_s, Witness& witness);

}  // namespace mebots::check
