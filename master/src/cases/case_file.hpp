// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/system_description.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Unit tests of a single FMU. CSV files contain their inputs and expected outputs.
namespace mebots::master::cases {

/// The tolerated difference of a Real from its expected value: absolute + relative * |expected|. Values of other types
/// must be equal.
struct Tolerance {
  double absolute = 1e-9;
  double relative = 1e-6;

  double of(double expected) const;
};

struct VariableTolerance {
  std::string pattern;  ///< `*` matches any characters, `?` matches one character
  Tolerance tolerance;
};

struct CaseDescription {
  std::string name;
  std::vector<std::filesystem::path> inputs;  ///< absolute paths of files with columns for inputs
  std::filesystem::path expected;             ///< absolute path of a file with columns for expected values
  std::vector<Setting> parameters;
  std::optional<WrittenTime> step;           ///< default: the step of the default experiment
  std::optional<std::int64_t> stop_time_ns;  ///< default: the first communication point at or after the last row
  Tolerance tolerance;
  std::vector<VariableTolerance> tolerances;  ///< if several patterns match, the last one applies

  Tolerance tolerance_of(std::string_view variable) const;
};

struct CaseFile {
  std::filesystem::path folder = {};  ///< absolute path of the folder that contains the file
  /// Name of the FMU, or its path relative to `folder`. Empty if the file names no FMU.
  std::string fmu = {};
  std::vector<CaseDescription> cases = {};
};

/// Reads a file of cases. Throws InputError with all errors and their places if the file is invalid.
CaseFile read_cases(const std::filesystem::path& file);

}  // namespace mebots::master::cases
