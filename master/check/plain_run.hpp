// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "child.hpp"

#include <filesystem>

namespace mebots::check {

/// Number of steps of a plain run, and step size [s] if the description states none.
inline constexpr int kPlainSteps = 20;
inline constexpr double kPlainStep_s = 0.01;

/// Runs a co-simulation FMU with `instances` instances for a few steps, as the master does, and reads all scalar Real
/// outputs. The FMU is unpacked in `folder`. Must be called only in a child process.
void run_plainly(const std::filesystem::path& archive, const std::filesystem::path& folder, int instances,
                 double step_s, Witness& witness);

}  // namespace mebots::check
