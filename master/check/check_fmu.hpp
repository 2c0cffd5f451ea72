// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.hpp"

#include <atomic>
#include <filesystem>
#include <string>

namespace mebots::check {

struct Options {
  /// Accepted difference between full and half steps, relative to the output's largest magnitude in the run.
  double half_step_tolerance = 1e-3;
  double deadline_s = 30;         ///< maximum processor and sleeping time of each experiment [s]
  Level level = Level::standard;  ///< the report counts findings of higher levels, but does not show them
  /// If this flag becomes true, the check throws Interrupted. If null, the check cannot be cancelled.
  const std::atomic<bool>* given_up = nullptr;
  bool run = true;  ///< if false, examines only files and runs no code of the FMU
};

/// Checks the archive, description, binaries and behaviour of an FMU. The FMU's code runs in child processes. Throws
/// Error if the file cannot be read.
Report check_fmu(const std::filesystem::path& fmu, const Options& options);

/// Returns the report as text: the findings by group, with their remedies.
std::string to_text(const Report& report);
/// Returns the report as JSON with the keys fmu, summary, level, clean, errors, warnings, platforms [{folder, machine,
/// glibc, missing}], checks [{group, name, result, why, findings}].
std::string to_json(const Report& report);

}  // namespace mebots::check
