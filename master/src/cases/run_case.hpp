// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cases/case_file.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace mebots::master::cases {

/// A value that differs from the expected value.
struct Divergence {
  double time_s = 0;
  std::string variable;
  std::string expected;
  std::string got;
  std::optional<double> difference;  ///< set only for numbers
  double tolerance = 0;

  /// Returns a text such as "at 0.5 s y is 3, expected 2 (difference 1, tolerance 2e-06)".
  std::string text() const;
};

enum class Verdict { passed, failed, error };

struct CaseResult {
  std::string name;
  Verdict verdict = Verdict::passed;
  std::string error;  ///< the reason why the run failed
  std::optional<Divergence> first;
  std::vector<std::string> others;  ///< variables that diverge later than `first`
  std::size_t rows = 0;             ///< number of compared rows
  std::size_t variables = 0;
  double wall_s = 0;

  /// Returns the reason why the case did not pass, or the number of compared values.
  std::string text() const;
};

struct CaseOptions {
  bool isolate = false;               ///< runs the FMU in a separate process
  std::filesystem::path folder = {};  ///< folder for the results; empty: writes no results
};

/// Runs the FMU alone with the inputs of a case, and compares its variables with each row of expected values.
/// Interpolates a continuous Real between communication points. Any other variable keeps the value of the earlier
/// point. If two expected rows have the same time, the value must match one of them. If the run fails, the result
/// contains the error.
CaseResult run_case(const std::filesystem::path& fmu, const CaseDescription& description,
                    const CaseOptions& options = {});

/// Runs the case `name` of a file. Returns JSON: {"verdict": "passed" | "failed" | "error", "text": ...}. `fmu` takes
/// precedence over the FMU in the file. Throws InputError if the file does not exist or lacks the case.
std::string run_case_as_json(const std::filesystem::path& file, const std::string& name,
                             const std::optional<std::filesystem::path>& fmu, bool isolate);

/// Returns the path of the FMU that a file names. Throws InputError if the file names no FMU, or if the FMU does not
/// exist.
std::filesystem::path fmu_of(const CaseFile& file);

std::string_view name_of(Verdict verdict);

}  // namespace mebots::master::cases
