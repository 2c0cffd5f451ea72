// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.hpp"

#include <atomic>
#include <filesystem>
#include <string>

namespace mebots::check {

struct Options {
  double half_step_tolerance = 1e-3;  ///< of an output's largest magnitude in the run
  double deadline_s = 30;             ///< for each experiment with the FMU: seconds that it computes or sleeps
  Level level = Level::standard;      ///< findings of higher levels are counted, not told
  const std::atomic<bool>* given_up = nullptr;  ///< true ends the check by Interrupted; null = nobody can
  bool run = true;                              ///< false: look at the files only, run nothing of the FMU's
};

/// Looks at an FMU from its archive to its behaviour. What the FMU's code does, it does in child processes.
/// Throws mebots::Error when the file cannot be read at all.
Report check_fmu(const std::filesystem::path& fmu, const Options& options);

/// The report for people: findings by group, with what to do.
std::string to_text(const Report& report);
/// The report for machines. Keys: fmu, summary, level, clean, errors, warnings, checks [{group, name, result, why,
/// findings}].
std::string to_json(const Report& report);

}  // namespace mebots::check
