// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "child.hpp"
#include "fmi3_description.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

/// Experiments with an FMI 3.0 FMU through its C interface, as in an importing tool.
namespace mebots::check {

struct Fmi3Target {
  const Fmi3Description* description;
  std::filesystem::path folder;   ///< the unpacked FMU
  std::filesystem::path library;  ///< its shared library
};

class Fmi3Library;

/// The part of the reference traces that a run can be compared with. Columns may have names of FMI 2.0 where this FMU
/// has arrays.
struct Fmi3TraceScope {
  std::string obstacle = {};  ///< reason why nothing can be compared; empty if something can
  std::size_t columns = 0;    ///< number of output columns; 0 with an obstacle
  std::size_t compared = 0;   ///< number of output columns that are numbers of this FMU
};

/// If a file cannot be read, there is no obstacle: replay_trace() throws the error.
Fmi3TraceScope fmi3_trace_scope(const Fmi3Target& target);
/// Compares a run with the reference traces. Output columns that are no numbers of this FMU are ignored.
void replay_trace(const Fmi3Library& library);

/// Returns the probes of co-simulation.
std::vector<ChildProbe> fmi3_probes(const Fmi3Target& target);

}  // namespace mebots::check
