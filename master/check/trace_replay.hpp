// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subject.hpp"

#include <optional>

namespace mebots::check {

/// Reference traces that travel in an FMU: `documentation/reference/<name>_in.csv` and `<name>_out.csv`, or the result
/// that `extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml` names, with its `_in.csv` beside it.
struct TraceFiles {
  std::filesystem::path inputs;  ///< empty when there is none
  std::filesystem::path outputs;
  /// One file for the FMI 2.0 and 3.0 versions of a model: what this FMU has not, or not as a number, is passed over.
  bool of_many_versions = false;
};

/// The traces of an unpacked FMU, if it has any.
std::optional<TraceFiles> find_traces(const std::filesystem::path& folder);

/// Steps from row to row of the outputs' file, with the inputs of the last row that is not later, and compares.
/// Reals may differ by 1e-6 of their value (another compiler rounds differently), all else not at all.
/// Reports the first divergence.
void replay(const Library& library, const TraceFiles& files);

}  // namespace mebots::check
