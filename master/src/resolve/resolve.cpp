// SPDX-License-Identifier: Apache-2.0
#include "resolve/resolve.hpp"

#include "mebots/modeldesc/declared_variable.hpp"
#include "mebots/nearest_names.hpp"
#include "model/value_kind.hpp"
#include "resolve/clock_groups.hpp"
#include "resolve/signal_coverage.hpp"
#include "resolve/step_control.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Variable;

std::vector<StartValue> resolve_starts(const InstanceDescription& instance,
                                       const modeldesc::ModelDescription& description) {
  std::map<std::string, StartValue> starts;  // the last assignment applies: settings follow the config
  for (const auto& assignment : instance.parameters) {
    starts[assignment.variable] = checked_start(instance, description, assignment);
  }
  std::vector<StartValue> result;
  for (const auto& variable : description.variables) {
    const auto found = starts.find(variable.name);
    if (found == starts.end() || variable.causality == Causality::structural_parameter) continue;
    result.push_back(found->second);
  }
  return result;
}

/// The log categories that the config requests; the key is the name of an instance.
using LogSections = std::unordered_map<std::string_view, const std::vector<std::string>*>;

LogSections log_sections(const SystemDescription& system) {
  LogSections sections;
  for (const auto& log : system.log) sections.emplace(log.instance, &log.categories);
  return sections;
}

std::vector<std::string> log_categories(const LogSections& sections, const InstanceDescription& instance) {
  const auto found = sections.find(instance.name);
  if (found != sections.end()) return *found->second;
  return {std::begin(kDefaultLogCategories), std::end(kDefaultLogCategories)};
}

/// Adds a notice for each requested log category that the FMU does not declare. This is no error, because some FMUs do
/// not declare all of their categories.
void note_unknown_categories(ResolvedSystem& system) {
  for (const auto& log : system.description->log) {
    const auto instance = system.description->index_of(log.instance);
    if (!instance) {
      throw InputError(ErrorCode::unknown_name, fmt::format("log: there is no instance '{}'", log.instance));
    }
    std::vector<std::string> known;
    for (const auto& category : system.instances[*instance].model->log_categories) {
      known.push_back(category.name);
    }
    for (const auto& category : log.categories) {
      if (known.empty() || category == "*" || std::ranges::find(known, category) != known.end()) continue;
      system.notices.push_back(fmt::format("{}: its FMU declares no log category '{}'. {}", log.instance, category,
                                           suggest(category, known)));
    }
  }
}

/// Sets the tolerance of an instance: that of the config or, if absent, the FMU's default. Ignores a default that is
/// not positive, and adds a notice.
void resolve_tolerance(ResolvedInstance& instance, std::vector<std::string>& notices) {
  const auto& description = *instance.description;
  if (!description.pass_tolerance) return;
  const auto& usual = instance.model->default_experiment;
  instance.tolerance = description.tolerance ? description.tolerance : usual.usable_tolerance();
  if (usual.tolerance && !instance.tolerance) {
    notices.push_back(
        fmt::format("{}: its FMU has a default tolerance of {}, which is not passed to it, because a tolerance "
                    "must be above 0. Set \"tolerance\" to pass one",
                    description.name, *usual.tolerance));
  }
}

/// Adds a notice about invalid parts of modelDescription.xml that the reader has ignored. The notice contains only the
/// first part and the number of the others.
void note_structure_faults(const ResolvedInstance& instance, std::vector<std::string>& notices) {
  const auto& faults = instance.model->structure_faults;
  if (faults.empty()) return;
  const auto others = faults.size() == 1 ? "" : fmt::format(" ({} more by `mebots check`)", faults.size() - 1);
  notices.push_back(fmt::format("{}: parts of its modelDescription.xml are ignored: {}{}", instance.description->name,
                                faults.front(), others));
}

void note_archives(ResolvedSystem& system) {
  std::set<const Fmu*> seen;
  for (const auto& instance : system.instances) {
    if (!seen.insert(instance.fmu.get()).second) continue;
    const auto& notices = instance.fmu->notices();
    system.notices.insert(system.notices.end(), notices.begin(), notices.end());
  }
}

/// Throws InputError if the config requires that discarded steps are repeated in shorter parts (`on_discard`), but the
/// FMU does not support this. The FMU must be able to restore its state and to take steps of any length.
void check_division(const ResolvedInstance& instance) {
  if (!instance.description->divide_discarded || instance.kind == FmuKind::model_exchange) return;
  const auto& flags = *instance.model->co_simulation;
  if (flags.can_get_and_set_fmu_state && flags.can_handle_variable_communication_step_size) return;
  throw InputError(
      ErrorCode::not_offered,
      fmt::format("{}/on_discard: a step of '{}' cannot be divided: its FMU declares {} = false",
                  instance.description->place, instance.description->name,
                  flags.can_get_and_set_fmu_state ? "canHandleVariableCommunicationStepSize" : "canGetAndSetFMUstate"));
}

/// Returns the name of the OSMP binary that contains the Integer, or the name of the variable if it is no such Integer.
std::string whole_name(const modeldesc::ModelDescription& description, const Variable& variable) {
  if (!is_osmp_part(description, variable)) return variable.name;
  for (const std::string_view ending : kOsmpEndings) {
    if (variable.name.ends_with(ending)) return variable.name.substr(0, variable.name.size() - ending.size());
  }
  return variable.name;
}

/// True if the alternative of an input is connected. The text `x.base64` is an alternative to the binary `x`. Only one
/// of them needs a connection.
bool has_connected_alternative(const modeldesc::ModelDescription& description, const Variable& variable,
                               const std::set<const Variable*>& served) {
  constexpr std::string_view kEnding = ".base64";
  if (!variable.name.ends_with(kEnding)) return false;
  const auto binary = variable.name.substr(0, variable.name.size() - kEnding.size());
  const auto* part = description.find(binary + ".size");
  return part != nullptr && is_osmp_part(description, *part) && served.count(part) != 0;
}

/// Throws InputError if the config sets an input that a connection overwrites.
void refuse_values_of_connected_inputs(const ResolvedSystem& system) {
  using Target = std::pair<std::size_t, std::string_view>;
  std::map<Target, const Assignment*> given;
  for (std::size_t i = 0; i < system.instances.size(); ++i) {
    for (const auto& assignment : system.instances[i].description->parameters) {
      given.emplace(Target(i, assignment.variable), &assignment);
    }
  }
  for (const auto& connection : system.connections) {
    const auto found = given.find(Target(connection.to.instance, connection.to.variable->name));
    if (found == given.end()) continue;
    throw InputError(ErrorCode::invalid_value,
                     fmt::format("{}: '{}' gets its value from {}, so the value given here would have no effect. "
                                 "Remove the value or the connection",
                                 found->second->place, system.text(connection.to), system.text(connection.from)));
  }
}

bool has_own_timing(const Variable& variable) {
  return variable.type == modeldesc::Type::clock && variable.fmi3->timing->is_time_based();
}

void note_open_inputs(ResolvedSystem& system) {
  auto connection = system.connections.begin();  // in the order of the target instances
  auto input = system.inputs.begin();            // in the same order
  for (std::size_t i = 0; i < system.instances.size(); ++i) {
    const auto& instance = system.instances[i];
    std::set<const Variable*> served;
    for (; connection != system.connections.end() && connection->to.instance == i; ++connection) {
      served.insert(connection->to.variable);
    }
    for (const auto& start : instance.starts) served.insert(start.variable);
    for (; input != system.inputs.end() && input->first.instance == i; ++input) served.insert(input->first.variable);
    std::vector<std::string> open;
    for (const auto& variable : instance.model->variables) {
      if (variable.causality != Causality::input || served.count(&variable) != 0) continue;
      if (instance.clocks_tick && has_own_timing(variable)) continue;
      if (has_connected_alternative(*instance.model, variable, served)) continue;
      auto name = whole_name(*instance.model, variable);
      if (open.empty() || open.back() != name) open.push_back(std::move(name));
    }
    if (open.empty()) continue;
    system.notices.push_back(fmt::format("{}: not connected, so the FMU's start value is used: {}",
                                         instance.description->name, fmt::join(open, ", ")));
  }
}

}  // namespace

void with_place_of_fmu(const InstanceDescription& instance, const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& error) {
    throw InputError(error.code(), fmt::format("{}/fmu: {}", instance.place, error.what()));
  }
}

std::shared_ptr<Fmu> open_fmu(const InstanceDescription& instance, FmuLibrary& library) {
  std::shared_ptr<Fmu> fmu;
  with_place_of_fmu(instance, [&] { fmu = library.open(instance.fmu_path, instance.kind); });
  return fmu;
}

modeldesc::StructuralValues structural_values(const InstanceDescription& instance,
                                              const modeldesc::ModelDescription& description) {
  modeldesc::StructuralValues values;
  for (const auto& assignment : instance.parameters) {
    const auto* variable = description.find(assignment.variable);
    if (variable == nullptr || variable->causality != Causality::structural_parameter) continue;
    const auto start = checked_start(instance, description, assignment);
    values[variable->value_reference] = static_cast<std::uint64_t>(std::get<std::int64_t>(start.value));
  }
  return values;
}

const Variable* variable_of_setting(const modeldesc::ModelDescription& description, std::string_view name) {
  const auto* variable = modeldesc::declared_variable(description, name);
  if (variable == nullptr) return nullptr;
  const bool is_element = variable->name != name;
  return is_element == variable->fmi3->dimensions.empty() ? nullptr : variable;
}

std::string checked_setting(const InstanceDescription& instance, Fmu& fmu, const Assignment& setting) {
  const auto text_of = [](const StartValue& start) { return value_text(start.variable->type, start.value); };
  const auto& description = fmu.description();
  if (const auto* variable = variable_of_setting(description, setting.variable)) {
    auto whole = setting;
    whole.variable = variable->name;
    return text_of(checked_start(instance, description, whole));
  }
  const auto model = fmu.model(structural_values(instance, description));  // names of array elements for the error
  return text_of(checked_start(instance, *model, setting));
}

ResolvedSystem resolve(const SystemDescription& description, FmuLibrary& library,
                       const std::atomic<bool>& interrupted) {
  ResolvedSystem system;
  system.description = &description;
  system.notices = description.notices;
  const auto sections = log_sections(description);
  for (const auto& instance : description.instances) {
    ResolvedInstance resolved;
    stop_if_interrupted(interrupted);
    resolved.description = &instance;
    resolved.fmu = open_fmu(instance, library);
    resolved.structural = structural_values(instance, resolved.fmu->description());
    with_place_of_fmu(instance, [&] {
      resolved.model = resolved.fmu->model(resolved.structural);
      resolved.kind = resolved.fmu->kind();
    });
    resolved.clocks_tick = has_ticking_clocks(*resolved.model, resolved.kind);
    resolved.isolation = instance.isolation;
    if (resolved.implementation().needs_execution_tool) {
      system.notices.push_back(fmt::format(
          "{}: its FMU is a wrapper for a tool that must be installed (needsExecutionTool)", instance.name));
    }
    resolve_tolerance(resolved, system.notices);
    note_structure_faults(resolved, system.notices);
    resolved.starts = resolve_starts(instance, *resolved.model);
    resolved.log_categories = log_categories(sections, instance);
    system.instances.push_back(std::move(resolved));
  }
  note_archives(system);
  choose_processes(system, interrupted);  // also reports a missing library or function
  note_unknown_categories(system);
  for (const auto& instance : system.instances) check_division(instance);
  resolve_connections(system, interrupted);
  refuse_values_of_connected_inputs(system);
  resolve_signals(system);
  resolve_continuous_systems(system);
  note_open_inputs(system);
  resolve_clock_groups(system);
  resolve_step_control(system);
  return system;
}

}  // namespace mebots::master
