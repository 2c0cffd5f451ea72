// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "description.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mebots::new_fmu {

/// The files of a new FMU, as pairs of relative path and content.
using Files = std::vector<std::pair<std::filesystem::path, std::string>>;

/// Creates the sources of an FMU from a description.json: a model (a first-order lag between the declared variables), a
/// binding, a test, README and CMakeLists.txt. The folder builds unchanged. If `folder` is empty, uses the FMU's name
/// in the working folder. Returns the folder. Throws Error if the description cannot be read, or if the folder exists.
std::filesystem::path new_fmu(const std::filesystem::path& description, std::filesystem::path folder);

}  // namespace mebots::new_fmu

/// The plan of the new model's behaviour, which all writers use.
namespace mebots::new_fmu {

/// A Real output that follows its inputs with a first-order lag.
struct Lag {
  const modeldesc::Field* output = nullptr;
  std::vector<const modeldesc::Field*> inputs;  ///< Reals of the same unit; if empty, the output keeps its start value
  std::vector<double> rest;                     ///< start values by element
};

struct Plan {
  const modeldesc::Description* description = nullptr;
  std::vector<Lag> lags;
  const modeldesc::Field* time_constant = nullptr;  ///< a positive Real parameter in seconds, or null

  bool is_group(const modeldesc::Field& field) const { return field.group.has_value(); }
  /// Returns the C++ name of the group over which an array extends.
  const std::string& group(const modeldesc::Field& field) const { return description->groups[*field.group].name; }
};

Plan make_plan(const modeldesc::Description& description);

std::string model_header(const Plan& plan);
std::string model_source(const Plan& plan);
std::string binding_source(const Plan& plan);
std::string test_source(const Plan& plan);
std::string readme(const Plan& plan);
std::string cmake_lists(const Plan& plan);
/// Returns a file of cases for `mebots test` and its CSV files. Empty if the FMU has no Real outputs.
Files case_files(const Plan& plan);

}  // namespace mebots::new_fmu
