// SPDX-License-Identifier: Apache-2.0
#include "resolve/step_control.hpp"

#include "base/time.hpp"
#include "mebots/input_error.hpp"
#include "mebots/nearest_names.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <span>

namespace mebots::master {
namespace {

std::string instance_text(const ResolvedInstance& instance) {
  return fmt::format("'{}' ({})", instance.description->name, instance.model->model_name);
}

/// True also for an instance that keeps its longer step, and for model exchange, whose solver reaches any time.
bool takes_variable_steps(const ResolvedInstance& instance) {
  return instance.description->steps > 1 || instance.kind == FmuKind::model_exchange ||
         instance.model->co_simulation->can_handle_variable_communication_step_size;
}

void check_instances(const ResolvedSystem& system) {
  std::vector<std::string> names;
  for (const auto& instance : system.instances) {
    if (!takes_variable_steps(instance)) names.push_back(instance_text(instance));
  }
  if (names.empty()) return;
  throw InputError(
      ErrorCode::not_offered,
      fmt::format("{}: these instances cannot change their communication step "
                  "(canHandleVariableCommunicationStepSize is false): {}. Give each a \"step\" of its own, "
                  "a multiple of the system's step {} s, or remove \"step_control\"",
                  system.description->step_control->place, fmt::join(names, ", "),
                  time_text(system.description->step)));
}

const NamedTolerance* find_tolerance(const StepControlDescription& control, const std::string& name) {
  const auto found = std::ranges::find(control.tolerances, name, &NamedTolerance::name);
  return found == control.tolerances.end() ? nullptr : &*found;
}

std::span<const BondDescription> bonds_of(const SystemDescription& system) {
  return system.coupling ? std::span(system.coupling->bonds) : std::span<const BondDescription>();
}

/// Bonds, then inputs. All of them are measured unless a tolerance says otherwise, but of inputs only continuous ones.
std::vector<MeasuredCoupling> measured_of(const ResolvedSystem& system, std::set<std::string>& unused) {
  const auto& control = *system.description->step_control;
  std::vector<MeasuredCoupling> measured;
  const auto add = [&](const MeasuredCoupling& item, bool is_measured_by_default) {
    const auto* named = find_tolerance(control, item.name);
    unused.erase(item.name);
    if (named == nullptr ? !is_measured_by_default : !named->tolerance) return;
    measured.push_back(item);
    if (named != nullptr) measured.back().tolerance = *named->tolerance;
  };
  for (const auto& bond : bonds_of(*system.description)) {
    add({.name = bond.name, .tolerance = control.tolerance, .bond = &bond}, true);
  }
  for (std::size_t i = 0; i < system.connections.size(); ++i) {
    const auto& connection = system.connections[i];
    if (!connection.moves_real()) continue;
    add({.name = system.text(connection.to), .tolerance = control.tolerance, .connection = i},
        connection.is_continuous());
  }
  return measured;
}

void refuse_unknown(const ResolvedSystem& system, const NamedTolerance& named) {
  std::vector<std::string> names;
  for (const auto& bond : bonds_of(*system.description)) names.push_back(bond.name);
  for (const auto& connection : system.connections) {
    if (connection.moves_real()) names.push_back(system.text(connection.to));
  }
  throw InputError(ErrorCode::unknown_name,
                   fmt::format("{}: '{}' is neither a bond under \"coupling\" nor a Real input with one connection "
                               "between communication points. {}",
                               named.place, named.name, suggest(named.name, names)));
}

void find_measured(ResolvedSystem& system) {
  const auto& control = *system.description->step_control;
  std::set<std::string> unused;
  for (const auto& named : control.tolerances) unused.insert(named.name);
  system.step_control->measured = measured_of(system, unused);
  for (const auto& named : control.tolerances) {
    if (unused.contains(named.name)) refuse_unknown(system, named);
  }
  if (!system.step_control->measured.empty()) return;
  throw InputError(ErrorCode::invalid_value,
                   fmt::format("{}: there is nothing to measure: the system has no connection between continuous Reals "
                               "and no bond with a tolerance. Name inputs under \"tolerances\" or bonds under "
                               "\"coupling\", or remove \"step_control\"",
                               control.place));
}

/// Instances that cannot return to an earlier point.
std::vector<std::string> without_rollback(const ResolvedSystem& system) {
  std::vector<std::string> names;
  for (const auto& instance : system.instances) {
    const bool restores = instance.implementation().can_get_and_set_fmu_state && !instance.isolation.go_on_without;
    if (!restores) names.push_back(instance_text(instance));
  }
  return names;
}

void choose_rollback(ResolvedSystem& system) {
  const auto& control = *system.description->step_control;
  if (control.rollback == Rollback::never) return;
  const auto names = without_rollback(system);
  system.step_control->rolls_back = names.empty();
  if (names.empty()) return;
  const auto reason = fmt::format(
      "these instances cannot return to an earlier point (canGetAndSetFMUstate is false, or "
      "\"on_failure\" is \"continue\"): {}",
      fmt::join(names, ", "));
  if (control.rollback == Rollback::required) {
    throw InputError(ErrorCode::not_offered,
                     fmt::format("{}/rollback: {}. Let \"rollback\" be \"never\"", control.place, reason));
  }
  system.notices.push_back(fmt::format("step_control repeats no steps: {}", reason));
}

}  // namespace

void resolve_step_control(ResolvedSystem& system) {
  if (!system.description->step_control) return;
  system.step_control.emplace();
  check_instances(system);
  find_measured(system);
  choose_rollback(system);
}

}  // namespace mebots::master
