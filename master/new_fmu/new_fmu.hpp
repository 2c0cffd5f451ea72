// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "description.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mebots::new_fmu {

/// The files of a new FMU's folder: path inside it, and text.
using Files = std::vector<std::pair<std::filesystem::path, std::string>>;

/// Writes a folder that builds, from a description.json: model (a first-order lag between the variables that the
/// description declares), binding, test, README, CMakeLists.txt. `folder` empty = the FMU's name in the working folder.
/// Returns the folder. Throws mebots::Error for a description that cannot be read, or a folder that is there already:
/// nothing is ever overwritten.
std::filesystem::path new_fmu(const std::filesystem::path& description, std::filesystem::path folder);

}  // namespace mebots::new_fmu

/// What the new model does with the variables of its description: decided once, then written into each file.
namespace mebots::new_fmu {

/// A Real output that follows its inputs.
struct Lag {
  const modeldesc::Field* output = nullptr;
  std::vector<const modeldesc::Field*> inputs;  ///< Reals of the same unit; none = it stays where it starts
  std::vector<double> rest;                     ///< where it starts, one per element
};

struct Plan {
  const modeldesc::Description* description = nullptr;
  std::vector<Lag> lags;
  const modeldesc::Field* time_constant = nullptr;  ///< a Real parameter in seconds, if there is one above 0

  bool is_group(const modeldesc::Field& field) const { return field.group.has_value(); }
  /// Name of the group that a field's array goes over, as the generated namespace has it.
  const std::string& group(const modeldesc::Field& field) const { return description->groups[*field.group].name; }
};

Plan make_plan(const modeldesc::Description& description);

std::string model_header(const Plan& plan);
std::string model_source(const Plan& plan);
std::string binding_source(const Plan& plan);
std::string test_source(const Plan& plan);
std::string readme(const Plan& plan);
std::string cmake_lists(const Plan& plan);
/// A first file of cases for `mebots test`, with its CSV files; none for an FMU without Real outputs.
Files case_files(const Plan& plan);

}  // namespace mebots::new_fmu
