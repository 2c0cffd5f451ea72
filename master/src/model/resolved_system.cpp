// SPDX-License-Identifier: Apache-2.0
#include "model/resolved_system.hpp"

#include "mebots/nearest_names.hpp"
#include "model/value_kind.hpp"

#include <fmt/format.h>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Initial;
using modeldesc::Variability;
using modeldesc::Variable;

std::vector<std::string> variable_names(const modeldesc::ModelDescription& description) {
  std::vector<std::string> names;
  for (const auto& variable : description.variables) names.push_back(variable.name);
  return names;
}

std::vector<std::string> settable_names(const modeldesc::ModelDescription& description) {
  std::vector<std::string> names;
  for (const auto& variable : description.variables) {
    if (why_not_settable(variable).empty()) names.push_back(variable.name);
  }
  return names;
}

}  // namespace

Experiment ResolvedInstance::experiment(std::int64_t start_ns, std::int64_t stop_ns) const {
  Experiment result{.start_ns = start_ns, .tolerance = tolerance};
  if (description->pass_stop_time) result.stop_ns = stop_ns;
  return result;
}

bool ResolvedConnection::moves_real() const {
  return !inner && !sum && kind_of(from.variable->type) == ValueKind::real &&
         kind_of(to.variable->type) == ValueKind::real;
}

bool ResolvedConnection::is_continuous() const {
  return moves_real() && from.variable->variability == Variability::continuous &&
         to.variable->variability == Variability::continuous;
}

std::string why_not_settable(const Variable& variable) {
  if (variable.variability == Variability::constant) return "it is a constant";
  switch (variable.causality) {
    case Causality::parameter:
    case Causality::structural_parameter:
    case Causality::input:
      return {};
    case Causality::calculated_parameter:
    case Causality::dependent:
      return "it is calculated from other parameters";
    case Causality::independent:
      return "it is the independent variable (time), which the master sets";
    case Causality::output:
    case Causality::local:
      break;
  }
  if (variable.initial == Initial::exact || variable.initial == Initial::approx) return {};
  return fmt::format("it is of causality {} and calculated by the FMU", modeldesc::to_string(variable.causality));
}

ResolvedVariable ResolvedSystem::find(const VariableName& name, const std::string& place) const {
  const auto instance = description->index_of(name.instance);
  if (!instance) {
    throw InputError(ErrorCode::unknown_name, fmt::format("{}: there is no instance '{}'. {}", place, name.instance,
                                                          suggest(name.instance, description->instance_names())));
  }
  const auto& model = *instances[*instance].model;
  const auto* variable = model.find(name.variable);
  if (variable == nullptr) {
    throw InputError(ErrorCode::unknown_name,
                     fmt::format("{}: instance '{}' ({}) has no variable '{}'. {}", place, name.instance,
                                 model.model_name, name.variable, suggest(name.variable, variable_names(model))));
  }
  return {*instance, variable};
}

const InputSignal* ResolvedSystem::input_signal(const ResolvedVariable& input) const {
  const auto found = inputs.find(input);
  return found == inputs.end() ? nullptr : &found->second;
}

std::string ResolvedSystem::text(const ResolvedVariable& variable) const {
  return instances[variable.instance].description->name + "." + variable.variable->name;
}

StartValue checked_start(const InstanceDescription& instance, const modeldesc::ModelDescription& description,
                         const Assignment& assignment) {
  const auto* variable = description.find(assignment.variable);
  if (variable == nullptr) {
    throw InputError(ErrorCode::unknown_name,
                     fmt::format("{}: instance '{}' ({}) has no variable '{}'. {}", assignment.place, instance.name,
                                 description.model_name, assignment.variable,
                                 suggest(assignment.variable, settable_names(description))));
  }
  if (const auto why = why_not_settable(*variable); !why.empty()) {
    throw InputError(ErrorCode::invalid_value, fmt::format("{}: '{}.{}' cannot be set: {}", assignment.place,
                                                           instance.name, variable->name, why));
  }
  return {variable, typed_value(description, *variable, assignment.value, assignment.place)};
}

}  // namespace mebots::master
