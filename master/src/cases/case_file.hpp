// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/system_description.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Unit tests of a single FMU: inputs and expected outputs in CSV files.
namespace mebots::master::cases {

/// A Real may differ from its expected value by absolute + relative * |expected|. All other values are compared
/// exactly.
struct Tolerance {
  double absolute = 1e-9;
  double relative = 1e-6;

  double of(double expected) const;
};

struct VariableTolerance {
  std::string pattern;  ///< `*` stands for any characters, `?` for one
  Tolerance tolerance;
};

struct CaseDescription {
  std::string name;
  std::vector<std::filesystem::path> inputs;  ///< absolute; their columns are named after inputs
  std::filesystem::path expected;             ///< absolute; its columns are named after variables
  std::vector<Setting> parameters;
  std::optional<WrittenTime> step;           ///< if absent, the default experiment's
  std::optional<std::int64_t> stop_time_ns;  ///< if absent, the first communication point at or after the last row
  Tolerance tolerance;
  std::vector<VariableTolerance> tolerances;  ///< the last that fits a variable applies to it

  Tolerance tolerance_of(std::string_view variable) const;
};

struct CaseFile {
  std::filesystem::path folder = {};  ///< absolute
  std::string fmu = {};  ///< a name or a path from the folder, as in a config; empty if the file names none
  std::vector<CaseDescription> cases = {};
};

/// Reads a file of cases. Throws InputError that lists all mistakes with their places.
CaseFile read_cases(const std::filesystem::path& file);

}  // namespace mebots::master::cases
