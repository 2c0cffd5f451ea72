// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "run/run.hpp"

#include <string>
#include <vector>

namespace mebots::app {

/// Returns the report of a run after its end: outcome, speed, the summary's values with units, and the place of the
/// files. Values share at most ten lines; with `verbose`, each value has its own line.
std::vector<std::string> end_lines(const master::Run& run, bool verbose);

/// Describes a run at t = 0: instances, connections, steps, columns of the results.
std::vector<std::string> start_lines(const master::Run& run);

}  // namespace mebots::app
