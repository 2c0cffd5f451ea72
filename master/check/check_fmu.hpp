// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.hpp"

#include <atomic>
#include <filesystem>
#include <string>

namespace mebots::check {

struct Options {
  double half_step_tolerance = 1e-3;            ///< relative to an output's largest magnitude in the run
  double deadline_s = 30;                       ///< for each experiment: seconds of computing or sleeping
  Level level = Level::standard;                ///< findings of higher levels are counted, not reported
  const std::atomic<bool>* given_up = nullptr;  ///< true ends the check by Interrupted; null = never
  bool run = true;                              ///< false: examine the files only and run none of the FMU's code
};

/// Examines an FMU from its archive to its behaviour. The FMU's code runs in child processes. Throws mebots::Error if
/// the file cannot be read.
Report check_fmu(const std::filesystem::path& fmu, const Options& options);

/// Returns the report as readable text: findings by group, with remedies.
std::string to_text(const Report& report);
/// Returns the report as JSON. Its keys are fmu, summary, level, clean, errors, warnings, platforms [{folder, machine,
/// glibc, missing}], checks [{group, name, result, why, findings}].
std::string to_json(const Report& report);

}  // namespace mebots::check
