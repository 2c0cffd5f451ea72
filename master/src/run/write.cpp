// SPDX-License-Identifier: Apache-2.0
#include "run/run.hpp"

#include "mebots/input_error.hpp"
#include "model/value_kind.hpp"
#include "run/json_value.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Type;
using modeldesc::Variability;

/// Converts a number to the variable's type: 1.0 becomes 1 for an Integer and true for a Boolean.
WrittenValue as_written(const modeldesc::Variable& variable, double value) {
  const bool whole = value == std::floor(value) && std::abs(value) < 1e15;
  if (fmi::is_whole(variable.type) && whole) return static_cast<std::int64_t>(value);
  if (variable.type == Type::boolean && (value == 0 || value == 1)) return value != 0;
  return value;
}

bool is_settable(const modeldesc::Variable& variable) {
  return variable.causality == Causality::input ||
         (variable.causality == Causality::parameter && variable.variability == Variability::tunable);
}

const ResolvedConnection* connection_to(const ResolvedSystem& system, const ResolvedVariable& target) {
  const auto found_in = [&](const std::vector<ResolvedConnection>& connections) -> const ResolvedConnection* {
    const auto found = std::ranges::find(connections, target, &ResolvedConnection::to);
    return found == connections.end() ? nullptr : &*found;
  };
  if (const auto* const found = found_in(system.connections); found != nullptr) return found;
  for (const auto& group : system.clock_groups) {
    if (const auto* const found = found_in(group.connections); found != nullptr) return found;
  }
  for (const auto& continuous : system.continuous_systems) {
    if (const auto* const found = found_in(continuous.clock_connections); found != nullptr) return found;
  }
  return nullptr;
}

void check_settable(const Run& run, const ResolvedVariable& target, std::string_view name) {
  if (run.state() == RunState::ended) {
    throw InputError(ErrorCode::wrong_call_order, fmt::format("'{}' cannot be set: the run has ended", name));
  }
  const auto& variable = *target.variable;
  if (!is_settable(variable)) {
    throw InputError(ErrorCode::invalid_argument,
                     fmt::format("'{}' is {} of variability {}: only inputs and tunable parameters can be set in a run",
                                 name, to_string(variable.causality), to_string(variable.variability)));
  }
  if (const auto* connection = connection_to(run.resolved(), target); connection != nullptr) {
    throw InputError(ErrorCode::invalid_argument,
                     fmt::format("'{}' is connected to '{}', which would overwrite the value", name,
                                 run.resolved().text(connection->from)));
  }
  if (const auto* input = run.resolved().input_signal(target); input != nullptr) {
    throw InputError(ErrorCode::invalid_argument, fmt::format("'{}' gets its value from {}, which would overwrite it",
                                                              name, input->description.file->name));
  }
}

}  // namespace

ResolvedVariable find_variable(const Run& run, std::string_view name) {
  const auto& system = run.resolved();
  const auto place = fmt::format("'{}'", name);
  return system.find(parse_variable(*system.description, name, place), place);
}

nlohmann::ordered_json write_variable(Run& run, std::string_view name, double value, const std::string& place) {
  const auto target = find_variable(run, name);
  check_settable(run, target, name);
  // Checks type, range and enumeration items as for values in a config.
  const auto& model = *run.resolved().instances[target.instance].model;
  const auto typed = typed_value(model, *target.variable, as_written(*target.variable, value), place);
  const ValueReference reference[] = {target.variable->value_reference};
  run.call(target.instance, "write()", [&](Slave& slave) {
    if (const auto* real = std::get_if<double>(&typed)) slave.set_reals(reference, {real, 1});
    if (const auto* integer = std::get_if<std::int64_t>(&typed)) slave.set_integers(reference, {integer, 1});
    if (const auto* boolean = std::get_if<bool>(&typed)) {
      const std::int64_t flag = *boolean ? 1 : 0;
      slave.set_booleans(reference, {&flag, 1});
    }
  });
  run.note_write(fmt::format("{}={}", name, value_text(target.variable->type, typed)));
  return json_of(target.variable->type, typed);
}

nlohmann::ordered_json writable_variables(const ResolvedSystem& system) {
  auto list = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < system.instances.size(); ++i) {
    const auto& model = *system.instances[i].model;
    for (const auto& variable : model.variables) {
      const ResolvedVariable target{i, &variable};
      if (!is_settable(variable) || !is_number(variable.type) || is_osmp_part(model, variable)) continue;
      if (connection_to(system, target) != nullptr || system.input_signal(target) != nullptr) continue;
      list.push_back({{"variable", system.text(target)},
                      {"unit", variable.unit},
                      {"text", variable.text},
                      {"type", to_string(variable.type)}});
    }
  }
  return list;
}

}  // namespace mebots::master
