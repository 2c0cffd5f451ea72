// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subject.hpp"

#include <optional>

namespace mebots::check {

/// Reference traces that travel in an FMU: `documentation/reference/<name>_in.csv` and `<name>_out.csv`.
struct TraceFiles {
  std::filesystem::path inputs;  ///< empty when there is none
  std::filesystem::path outputs;
};

/// The traces of an unpacked FMU, if it has any.
std::optional<TraceFiles> find_traces(const std::filesystem::path& folder);

/// Steps from row to row of the outputs' file, with the inputs of the last row that is not later, and compares.
/// Reals may differ by 1e-6 of their value (another compiler rounds differently), all else not at all.
/// Reports the first divergence.
void replay(const Library& library, const TraceFiles& files);

}  // namespace mebots::check
