// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "child.hpp"
#include "fmi3_description.hpp"
#include "trace_file.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

/// Declares experiments that call an FMI 3.0 FMU through its C interface, as an importing tool does.
namespace mebots::check {

struct Fmi3Target {
  const Fmi3Description* description;
  std::filesystem::path folder;   ///< the unpacked FMU
  std::filesystem::path library;  ///< its shared library
};

class Fmi3Library;

/// Returns which columns of the reference traces can be compared with a run. If the FMU has arrays, the columns may
/// have the names of the scalars of its FMI 2.0 version.
TraceScope fmi3_trace_scope(const Fmi3Target& target);
/// Compares a run with the reference traces. Ignores output columns that are not numeric variables of this FMU.
void replay_trace(const Fmi3Library& library);

/// Returns the probes for co-simulation.
std::vector<ChildProbe> fmi3_probes(const Fmi3Target& target);

}  // namespace mebots::check
