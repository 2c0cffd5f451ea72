// SPDX-License-Identifier: Apache-2.0
#include "resolve/step_control.hpp"

#include "base/time.hpp"
#include "mebots/input_error.hpp"
#include "mebots/nearest_names.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <span>
#include <string_view>
#include <utility>

namespace mebots::master {
namespace {

std::string instance_text(const ResolvedInstance& instance) {
  return fmt::format("'{}' ({})", instance.description->name, instance.model->model_name);
}

/// True if step control may change the step of the instance. This includes instances with a longer step than the
/// system, and model exchange instances, whose solver can stop at any time.
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
  throw InputError(ErrorCode::not_offered,
                   fmt::format("{}: these instances cannot change their communication step "
                               "(canHandleVariableCommunicationStepSize is false): {}. Give each a \"step\" that is "
                               "longer than the system's step {} s, or remove \"step_control\"",
                               system.description->step_control->place, fmt::join(names, ", "),
                               time_text(system.description->step)));
}

std::span<const BondDescription> bonds_of(const SystemDescription& system) {
  return system.coupling ? std::span(system.coupling->bonds) : std::span<const BondDescription>();
}

/// Selects the measured bonds and inputs according to the tolerances in the config.
class MeasuredChoice {
 public:
  explicit MeasuredChoice(const StepControlDescription& control) : general_(control.tolerance) {
    for (const auto& named : control.tolerances) named_.emplace(named.name, &named);
  }

  void add(MeasuredCoupling item, bool is_measured_by_default) {
    item.tolerance = general_;
    const auto found = named_.find(item.name);
    if (found != named_.end()) {
      const auto& tolerance = found->second->tolerance;
      is_measured_by_default = tolerance.has_value();
      item.tolerance = tolerance.value_or(general_);
      named_.erase(found);
    }
    if (is_measured_by_default) measured_.push_back(std::move(item));
  }
  std::vector<MeasuredCoupling> take() { return std::move(measured_); }
  /// Returns a tolerance in the config for which no bond or input exists; null if there is no such tolerance.
  const NamedTolerance* unused() const { return named_.empty() ? nullptr : named_.begin()->second; }

 private:
  CouplingTolerance general_;
  std::map<std::string_view, const NamedTolerance*> named_;
  std::vector<MeasuredCoupling> measured_;
};

[[noreturn]] void refuse_unknown(const ResolvedSystem& system, const NamedTolerance& named) {
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

/// Lists the measured bonds and inputs. All bonds and all continuous inputs are measured, unless a tolerance excludes
/// them.
void find_measured(ResolvedSystem& system) {
  const auto& control = *system.description->step_control;
  MeasuredChoice choice(control);
  for (const auto& bond : bonds_of(*system.description)) choice.add({.name = bond.name, .bond = &bond}, true);
  for (std::size_t i = 0; i < system.connections.size(); ++i) {
    const auto& connection = system.connections[i];
    if (!connection.moves_real()) continue;
    choice.add({.name = system.text(connection.to), .connection = i}, connection.is_continuous());
  }
  if (const auto* named = choice.unused()) refuse_unknown(system, *named);
  system.step_control->measured = choice.take();
  if (!system.step_control->measured.empty()) return;
  throw InputError(ErrorCode::invalid_value,
                   fmt::format("{}: there is nothing to measure: the system has no connection between continuous Reals "
                               "and no bond with a tolerance. Name inputs under \"tolerances\" or bonds under "
                               "\"coupling\", or remove \"step_control\"",
                               control.place));
}

/// Returns the names of all instances that cannot return to an earlier communication point.
std::vector<std::string> without_rollback(const ResolvedSystem& system) {
  std::vector<std::string> names;
  for (const auto& instance : system.instances) {
    const bool restores = instance.implementation().can_get_and_set_fmu_state && !instance.isolation.continue_without;
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
                     fmt::format("{}/rollback: {}. Set \"rollback\" to \"never\"", control.place, reason));
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
