// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "run/run.hpp"

#include <string>
#include <vector>

namespace mebots::app {

/// What is shown of a run that is over: outcome, speed, the summary's values with their units, where the files are.
/// Values share lines, of which there are at most ten in all; `verbose` gives each value a line.
std::vector<std::string> end_lines(const master::Run& run, bool verbose);

/// What a run at t = 0 consists of: instances, connections, steps, columns of the results.
std::vector<std::string> start_lines(const master::Run& run);

}  // namespace mebots::app
