// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "child.hpp"
#include "fmi3_description.hpp"
#include "trace_file.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

/// Experiments that call an FMI 3.0 FMU through its C interface.
namespace mebots::check {

struct Fmi3Target {
  const Fmi3Description* description;
  std::filesystem::path folder;
  std::filesystem::path library;
};

class Fmi3Library;

/// Returns the columns of the reference traces that can be compared with a run. Columns may use the scalar names of an
/// FMI 2.0 version.
TraceScope fmi3_trace_scope(const Fmi3Target& target);
/// Compares a run with the reference traces. Ignores columns that are not numeric variables of this FMU.
void replay_trace(const Fmi3Library& library);

std::vector<ChildProbe> fmi3_probes(const Fmi3Target& target);

}  // namespace mebots::check
