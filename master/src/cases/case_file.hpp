// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/system_description.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Unit tests of a single FMU: inputs and expected outputs in CSV files.
namespace mebots::master::cases {

/// A Real may differ from its expected value by absolute + relative * |expected|. Other values are compared exactly.
struct Tolerance {
  double absolute = 1e-9;
  double relative = 1e-6;

  double of(double expected) const;
};

struct VariableTolerance {
  std::string pattern;  ///< `*` matches any characters, `?` one
  Tolerance tolerance;
};

struct CaseDescription {
  std::string name;
  std::vector<std::filesystem::path> inputs;  ///< absolute; columns are named after inputs
  std::filesystem::path expected;             ///< absolute; columns are named after variables
  std::vector<Setting> parameters;
  std::optional<WrittenTime> step;           ///< if absent, that of the default experiment
  std::optional<std::int64_t> stop_time_ns;  ///< if absent, the first communication point at or after the last row
  Tolerance tolerance;
  std::vector<VariableTolerance> tolerances;  ///< the last match for a variable applies

  Tolerance tolerance_of(std::string_view variable) const;
};

struct CaseFile {
  std::filesystem::path folder = {};  ///< absolute
  std::string fmu = {};  ///< a name, or a path relative to the folder, as in a config; empty if the file names none
  std::vector<CaseDescription> cases = {};
};

/// Reads a file of cases. Throws InputError with all mistakes and their places.
CaseFile read_cases(const std::filesystem::path& file);

}  // namespace mebots::master::cases
