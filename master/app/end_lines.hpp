// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "run/run.hpp"

#include <string>
#include <vector>

namespace mebots::app {

/// Returns the lines that report the end of a run: outcome, speed, summary values with units, and paths of the written
/// files. The values fill at most ten lines. If `verbose` is true, each value has its own line.
std::vector<std::string> end_lines(const master::Run& run, bool verbose);

/// Returns the lines that describe a run at its start: instances, connections, steps and recorded columns.
std::vector<std::string> start_lines(const master::Run& run);

}  // namespace mebots::app
