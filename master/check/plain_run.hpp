// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "child.hpp"

#include <filesystem>

namespace mebots::check {

/// The number of steps of a plain run. The length of the steps is kPlainStep_s if the description states no step size.
inline constexpr int kPlainSteps = 20;
inline constexpr double kPlainStep_s = 0.01;

/// Runs `instances` instances of the co-simulation FMU that is unpacked in `folder` for a few steps, as the master
/// does, and reads all scalar Real outputs. Must be called only in a child process.
void run_plainly(const std::filesystem::path& archive, const std::filesystem::path& folder, int instances,
                 double step_s, Witness& witness);

}  // namespace mebots::check
