// SPDX-License-Identifier: Apache-2.0
#include "model/override_schedule.hpp"

#include "model/value_kind.hpp"

#include <fmt/format.h>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Type;
using modeldesc::Variability;

[[noreturn]] void fail(const OverrideDescription& override, const std::string& what) {
  throw InputError(ErrorCode::invalid_value,
                   fmt::format("{}: '{}' {}", override.place, override.variable.text(), what));
}

void check_limits(const OverrideDescription& override, const modeldesc::Variable& variable, double value) {
  if (variable.min && value < *variable.min) {
    fail(override, fmt::format("would go to {}, below its minimum {}", value, *variable.min));
  }
  if (variable.max && value > *variable.max) {
    fail(override, fmt::format("would go to {}, above its maximum {}", value, *variable.max));
  }
}

Override checked(const ResolvedSystem& system, const OverrideDescription& description,
                 std::shared_ptr<const Signal> signal) {
  Override override{
      &description, system.find(description.variable, description.place + "/variable"), {}, std::move(signal)};
  const auto& variable = *override.variable.variable;
  const auto& model = *system.instances[override.variable.instance].model;
  const bool tunable = variable.causality == Causality::parameter && variable.variability == Variability::tunable;
  if (variable.causality != Causality::input && variable.causality != Causality::output && !tunable) {
    fail(description,
         fmt::format("is {} of variability {}; inputs, outputs and tunable parameters can be overridden",
                     modeldesc::to_string(variable.causality), modeldesc::to_string(variable.variability)));
  }
  if (variable.type == Type::clock) fail(description, "is a Clock, which has no value to override");
  if (is_osmp_part(model, variable)) fail(description, "is part of a binary variable, which cannot be overridden");
  if (description.action == OverrideAction::signal) return override;
  if (!description.unit.empty() && description.unit != variable.unit) {
    fail(description, fmt::format("is in [{}], and the entry says [{}]", variable.unit.empty() ? "-" : variable.unit,
                                  description.unit));
  }
  switch (description.action) {
    case OverrideAction::set:
      override.value = typed_value(model, variable, description.value, description.place + "/set");
      break;
    case OverrideAction::freeze:
    case OverrideAction::signal:
      break;
    case OverrideAction::ramp:
      check_limits(description, variable, description.number);
      [[fallthrough]];
    default:
      if (!fmi::is_float(variable.type)) {
        fail(description, fmt::format("is of type {}; '{}' works on Real variables. Use 'set' or 'freeze'",
                                      modeldesc::to_string(variable.type), action_text(description)));
      }
  }
  return override;
}

}  // namespace

std::string action_text(const OverrideDescription& override) {
  switch (override.action) {
    case OverrideAction::set:
      return "set " + written_text(override.value);
    case OverrideAction::offset:
      return fmt::format("offset {}", override.number);
    case OverrideAction::scale:
      return fmt::format("scale {}", override.number);
    case OverrideAction::freeze:
      return "freeze";
    case OverrideAction::noise:
      return fmt::format("noise {}", override.number);
    case OverrideAction::signal:
      return fmt::format("signal {} of {}", override.column, override.file->name);
    case OverrideAction::ramp:
      break;
  }
  return fmt::format("ramp to {}", override.number);
}

OverrideSchedule::OverrideSchedule(const ResolvedSystem& system)
    : start_ns_(system.description->start_time_ns), grid_(system.description->grid()), inputs_(system.inputs.size()) {
  for (const auto& [variable, input] : system.inputs) {
    overrides_.push_back({&input.description, variable, {}, input.signal});
  }
  const auto& entries = system.description->scenario;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    overrides_.push_back(checked(system, entries[i], system.scenario_signals[i]));
  }
  started_ns_.resize(overrides_.size());
}

std::optional<std::int64_t> OverrideSchedule::begin_of(std::size_t override) const {
  const auto& description = *overrides_[override].description;
  return description.when ? started_ns_[override] : description.from_ns;
}

std::optional<std::int64_t> OverrideSchedule::since(std::size_t override, std::int64_t time_ns) const {
  const auto& description = *overrides_[override].description;
  const auto start = begin_of(override);
  if (!start || time_ns < *start) return std::nullopt;
  if (description.until_ns && time_ns >= *description.until_ns) return std::nullopt;
  if (description.duration_ns && grid_.has_passed(*start, time_ns, *description.duration_ns)) return std::nullopt;
  return start;
}

}  // namespace mebots::master
