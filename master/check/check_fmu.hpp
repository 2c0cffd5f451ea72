// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.hpp"

#include <atomic>
#include <filesystem>
#include <string>

namespace mebots::check {

struct Options {
  /// Accepted difference between full and half steps, relative to an output's largest magnitude in the run.
  double half_step_tolerance = 1e-3;
  double deadline_s = 30;         ///< longest processor and sleeping time of each experiment
  Level level = Level::standard;  ///< findings of higher levels are counted, not reported
  /// If it becomes true, the check throws Interrupted; null: the check cannot be cancelled.
  const std::atomic<bool>* given_up = nullptr;
  bool run = true;  ///< false: examines only the files and executes none of the FMU's code
};

/// Checks an FMU: its archive, its description, its binaries and its behaviour. The FMU's code runs in child processes.
/// Throws mebots::Error if the file cannot be read.
Report check_fmu(const std::filesystem::path& fmu, const Options& options);

/// Returns the report as text for a reader: the findings, sorted by group, with their remedies.
std::string to_text(const Report& report);
/// Returns the report as JSON. Its keys are fmu, summary, level, clean, errors, warnings, platforms [{folder, machine,
/// glibc, missing}], checks [{group, name, result, why, findings}].
std::string to_json(const Report& report);

}  // namespace mebots::check
