// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "child.hpp"
#include "fmi3_description.hpp"
#include "trace_file.hpp"

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

/// Returns the part of the reference traces with which a run can be compared. If this FMU has arrays, columns may still
/// have the names of the scalars of FMI 2.0.
TraceScope fmi3_trace_scope(const Fmi3Target& target);
/// Compares a run with the reference traces. Output columns that are no numbers of this FMU are ignored.
void replay_trace(const Fmi3Library& library);

/// Returns the probes of co-simulation.
std::vector<ChildProbe> fmi3_probes(const Fmi3Target& target);

}  // namespace mebots::check
