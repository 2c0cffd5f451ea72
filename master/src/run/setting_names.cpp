// SPDX-License-Identifier: Apache-2.0
#include "run/setting_names.hpp"

#include "mebots/input_error.hpp"
#include "mebots/nearest_names.hpp"
#include "model/name_pattern.hpp"
#include "model/resolved_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>
#include <utility>

namespace mebots::master {
namespace {

/// Returns the model description that results from the structural parameters set so far. Opens the FMU.
std::shared_ptr<const modeldesc::ModelDescription> model_of(const InstanceDescription& instance, FmuLibrary& library) {
  const auto fmu = open_fmu(instance, library);
  return fmu->model(structural_values(instance, fmu->description()));
}

/// Replaces each index in brackets by `[*]`.
std::string with_any_index(std::string_view name) {
  std::string result;
  bool in_brackets = false;
  for (const char c : name) {
    if (c == ']') in_brackets = false;
    if (!in_brackets) result += c;
    if (c != '[') continue;
    in_brackets = true;
    result += '*';
  }
  return result;
}

/// Returns the names of all variables that can be set. The elements of an array share one name.
std::vector<std::string> settable_groups(const SystemDescription& system, FmuLibrary& library) {
  std::set<std::string> known;
  std::vector<std::string> names;
  for (const auto& instance : system.instances) {
    const auto model = model_of(instance, library);
    for (const auto& variable : model->variables) {
      if (!why_not_settable(variable).empty()) continue;
      auto name = with_any_index(instance.name + "." + variable.name);
      if (known.insert(name).second) names.push_back(std::move(name));
    }
  }
  return names;
}

}  // namespace

std::vector<std::string> matching_variables(const SystemDescription& system, FmuLibrary& library,
                                            const std::string& name) {
  if (const auto variable = system.split(name)) {
    const auto& instance = *system.find_instance(variable->instance);
    if (variable_of_setting(open_fmu(instance, library)->description(), variable->variable) != nullptr) return {name};
  }
  std::vector<std::string> names;
  if (!is_pattern(name)) return names;
  for (const auto& instance : system.instances) {
    const auto model = model_of(instance, library);
    for (const auto& variable : model->variables) {
      auto full = instance.name + "." + variable.name;
      if (fits(full, name) || (system.single_fmu && fits(variable.name, name))) names.push_back(std::move(full));
    }
  }
  return names;
}

namespace {

/// True if an FMU has structural parameters, which may change sizes of arrays.
bool has_sizes(const SystemDescription& system, FmuLibrary& library) {
  return std::ranges::any_of(system.instances, [&](const InstanceDescription& instance) {
    const auto fmu = open_fmu(instance, library);
    return std::ranges::any_of(fmu->description().variables, [](const modeldesc::Variable& variable) {
      return variable.causality == modeldesc::Causality::structural_parameter;
    });
  });
}

/// If the name is a pattern, returns one setting for each variable that matches. Otherwise, returns the setting and
/// does not check the name.
std::vector<Setting> single_settings(const SystemDescription& system, FmuLibrary& library, const Setting& setting) {
  if (!is_pattern(setting.variable)) return {setting};
  std::vector<Setting> settings;
  for (auto& name : matching_variables(system, library, setting.variable))
    settings.push_back({std::move(name), setting.value, setting.place});
  if (!settings.empty()) return settings;
  throw InputError(
      ErrorCode::unknown_name,
      fmt::format("{}: no variable fits '{}'. {}{}", setting.place, setting.variable,
                  suggest(setting.variable, settable_groups(system, library)),
                  has_sizes(system, library) ? ". Set the sizes of arrays before a pattern of their elements" : ""));
}

}  // namespace

std::vector<CheckedSetting> checked_settings(SystemDescription& system, FmuLibrary& library, const Setting& setting) {
  std::vector<CheckedSetting> checked;
  for (const auto& single : single_settings(system, library, setting)) {
    auto located = locate(system, single);
    const auto& [instance, assignment] = located;
    const auto fmu = open_fmu(*instance, library);
    auto text =
        fmt::format("set {}.{}={}", instance->name, assignment.variable, checked_setting(*instance, *fmu, assignment));
    const auto* variable = fmu->description().find(assignment.variable);
    const bool is_size = variable != nullptr && variable->causality == modeldesc::Causality::structural_parameter;
    checked.push_back({std::move(located), std::move(text), is_size});
  }
  return checked;
}

}  // namespace mebots::master
