// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "run/run.hpp"

#include <string>
#include <vector>

namespace mebots::app {

/// Returns lines that report the end of a run: its outcome, its speed, the summary's values with units, and the paths
/// of the written files. The values fill at most ten lines; if `verbose` is true, each value has its own line.
std::vector<std::string> end_lines(const master::Run& run, bool verbose);

/// Returns lines that describe a run at t = 0: its instances, connections, steps and columns of results.
std::vector<std::string> start_lines(const master::Run& run);

}  // namespace mebots::app
