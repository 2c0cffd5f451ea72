// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/system_description.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Declares unit tests of a single FMU. Their inputs and expected outputs are in CSV files.
namespace mebots::master::cases {

/// The tolerated difference between a Real and its expected value: absolute + relative * |expected|. Other values must
/// be equal.
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
  std::vector<std::filesystem::path> inputs;  ///< absolute paths of files whose columns have the names of inputs
  std::filesystem::path expected;             ///< absolute path of a file whose columns have the names of variables
  std::vector<Setting> parameters;
  std::optional<WrittenTime> step;           ///< default: the step of the default experiment
  std::optional<std::int64_t> stop_time_ns;  ///< default: the first communication point at or after the last row
  Tolerance tolerance;
  std::vector<VariableTolerance> tolerances;  ///< if several patterns match a variable, the last one applies

  Tolerance tolerance_of(std::string_view variable) const;
};

struct CaseFile {
  std::filesystem::path folder = {};  ///< absolute path of the folder that contains the file
  /// Name of the FMU, or its path relative to the folder, as in a config; empty if the file names no FMU.
  std::string fmu = {};
  std::vector<CaseDescription> cases = {};
};

/// Reads a file of cases. If the file has mistakes, throws InputError with all mistakes and their places.
CaseFile read_cases(const std::filesystem::path& file);

}  // namespace mebots::master::cases
