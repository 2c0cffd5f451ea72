// SPDX-License-Identifier: Apache-2.0
#include "run/variable_units.hpp"

#include "io/config/load_system.hpp"
#include "resolve/resolve.hpp"

namespace mebots::master {

std::map<std::string, std::string> variable_units(const std::filesystem::path& config) {
  const auto system = read_config(config);
  FmuLibrary library;
  std::map<std::string, std::string> units;
  for (const auto& instance : resolve(system, library).instances) {
    for (const auto& variable : instance.model->variables) {
      if (!variable.unit.empty()) units[instance.description->name + "." + variable.name] = variable.unit;
    }
  }
  return units;
}

}  // namespace mebots::master
