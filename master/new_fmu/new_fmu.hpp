// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "description.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mebots::new_fmu {

/// The files to write into the folder of a new FMU; each entry has a relative path and a text.
using Files = std::vector<std::pair<std::filesystem::path, std::string>>;

/// Creates the sources of an FMU from a description.json and writes them into a folder that builds. The files are a
/// model (a first-order lag between the declared variables), a binding, a test, README and CMakeLists.txt. If `folder`
/// is empty, its name is the name of the FMU, in the working folder. Returns the folder. Throws mebots::Error if the
/// description cannot be read. Also throws if the folder exists, so that nothing is overwritten.
std::filesystem::path new_fmu(const std::filesystem::path& description, std::filesystem::path folder);

}  // namespace mebots::new_fmu

/// The plan of the new model's behaviour. It is made once, and all writers use it.
namespace mebots::new_fmu {

/// A Real output that follows its inputs.
struct Lag {
  const modeldesc::Field* output = nullptr;
  std::vector<const modeldesc::Field*> inputs;  ///< Reals of the same unit; empty = the output keeps its start value
  std::vector<double> rest;                     ///< start values, one per element
};

struct Plan {
  const modeldesc::Description* description = nullptr;
  std::vector<Lag> lags;
  const modeldesc::Field* time_constant = nullptr;  ///< a Real parameter in seconds, if there is one above 0

  bool is_group(const modeldesc::Field& field) const { return field.group.has_value(); }
  /// Returns the name of the group over which a field's array extends, in the generated namespace.
  const std::string& group(const modeldesc::Field& field) const { return description->groups[*field.group].name; }
};

Plan make_plan(const modeldesc::Description& description);

std::string model_header(const Plan& plan);
std::string model_source(const Plan& plan);
std::string binding_source(const Plan& plan);
std::string test_source(const Plan& plan);
std::string readme(const Plan& plan);
std::string cmake_lists(const Plan& plan);
/// Returns a first file of cases for `mebots test` with its CSV files; none if the FMU has no Real outputs.
Files case_files(const Plan& plan);

}  // namespace mebots::new_fmu
