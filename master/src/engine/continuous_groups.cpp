// SPDX-License-Identifier: Apache-2.0
#include "engine/continuous_groups.hpp"

#include "base/time.hpp"
#include "engine/clock_links.hpp"
#include "engine/discrete_links.hpp"
#include "slave/fmi/make_slave.hpp"
#include "slave/isolation/isolated_interfaces.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Variability;

/// The relative tolerance of the solver if neither the config nor an FMU declares one.
constexpr double kUsualTolerance = 1e-6;

/// Returns the smallest tolerance of the members. If no member has a tolerance, returns kUsualTolerance.
double tolerance_of(const ResolvedSystem& system, const std::vector<std::size_t>& members) {
  std::optional<double> smallest;
  for (const auto member : members) {
    const auto& tolerance = system.instances[member].tolerance;
    if (tolerance) smallest = std::min(*tolerance, smallest.value_or(*tolerance));
  }
  return smallest.value_or(kUsualTolerance);
}

/// Returns the inputs on which an output directly depends, as ModelStructure declares. If it has no entry with
/// `dependencies` for this output, returns nullopt: the output may depend on all inputs.
std::optional<std::vector<ValueReference>> dependencies_of(const modeldesc::ModelDescription& model,
                                                           const modeldesc::Variable& output) {
  const auto index = static_cast<std::size_t>(&output - model.variables.data());
  const auto found = std::ranges::find(model.outputs, index, &modeldesc::Unknown::variable);
  if (found == model.outputs.end() || !found->dependencies) return std::nullopt;
  std::vector<ValueReference> references;
  for (const auto dependency : *found->dependencies) {
    const auto& variable = model.variables[dependency];
    if (variable.causality == Causality::input) references.push_back(variable.value_reference);
  }
  return references;
}

/// Adds a slave to a group and wraps the slave for this group. `slave` and `instance` must be the same object.
std::unique_ptr<Slave> in_group(std::unique_ptr<Slave> slave, ContinuousInstance& instance, bool clocks_tick,
                                const std::shared_ptr<ContinuousGroup>& group) {
  if (!clocks_tick) return std::make_unique<ContinuousSlave>(std::move(slave), instance, group);
  auto holding = std::make_unique<HoldingSlave>(std::move(slave));
  auto& clocked = *holding;
  auto member = std::make_unique<ContinuousSlave>(std::move(holding), instance, group);
  group->clocks().add(member->index(), clocked, *instance.clocks());
  return member;
}

}  // namespace

ContinuousGroups::ContinuousGroups(const ResolvedSystem& system, MessageSink& messages, const SlaveOptions& options)
    : system_(system),
      messages_(messages),
      interrupted_(options.interrupted),
      places_(system.instances.size()),
      wires_(system.continuous_systems.size()),
      links_(system.continuous_systems.size()) {
  if (options.solvers != nullptr) options.solvers->resize(system.continuous_systems.size());
  for (std::size_t s = 0; s < system.continuous_systems.size(); ++s) {
    const auto& continuous = system.continuous_systems[s];
    for (std::size_t m = 0; m < continuous.members.size(); ++m) places_[continuous.members[m]] = {s, m};
    ContinuousGroup::Setup setup;
    setup.solver = *continuous.solver;
    if (const auto& control = system.description->step_control; control && !setup.solver.max_step_s) {
      setup.solver.max_step_s = to_seconds(system.description->length_of(control->max_steps));
    }
    setup.relative_tolerance = tolerance_of(system, continuous.members);
    setup.grid = system.description->grid();
    setup.messages = &messages;
    if (options.interrupted != nullptr) setup.interrupted = options.interrupted;
    if (options.solvers != nullptr) setup.statistics = &(*options.solvers)[s];
    groups_.push_back(std::make_shared<ContinuousGroup>(std::move(setup)));
  }
}

std::unique_ptr<Slave> ContinuousGroups::make_slave(std::size_t instance) {
  const auto& resolved = system_.instances[instance];
  const auto& group = groups_[places_[instance].system];
  if (resolved.isolation.alone()) {
    auto isolated = std::make_unique<isolation::IsolatedModelExchange>(resolved, messages_, interrupted_,
                                                                       system_.description->grid());
    auto& remote = *isolated;
    return in_group(std::move(isolated), remote, resolved.clocks_tick, group);
  }
  auto [slave, continuous] = make_continuous_here({.name = resolved.description->name,
                                                   .fmu = resolved.fmu,
                                                   .structural = resolved.structural,
                                                   .log_categories = resolved.log_categories,
                                                   .grid = system_.description->grid()},
                                                  messages_);
  return in_group(std::move(slave), *continuous, resolved.clocks_tick, group);
}

void ContinuousGroups::connect() {
  for (const auto& connection : system_.connections) {
    if (connection.inner) connect(connection);
  }
  for (std::size_t s = 0; s < groups_.size(); ++s) {
    groups_[s]->connect(std::move(wires_[s]), std::move(links_[s]));
    auto [clocks, values] = clock_links(system_.continuous_systems[s].clock_connections,
                                        [this](std::size_t instance) { return places_[instance].member; });
    groups_[s]->clocks().connect(std::move(clocks), std::move(values));
  }
}

/// True for a connection from an unclocked Real to a continuous Real. The solver transfers these values whenever it
/// evaluates the derivatives. All other connections, such as those of clocked variables, transfer values only at
/// events.
bool ContinuousGroups::is_wire(const ResolvedConnection& connection) const {
  return !is_clocked(*connection.from.variable) && kind_of(connection.from.variable->type) == ValueKind::real &&
         kind_of(connection.to.variable->type) == ValueKind::real &&
         connection.to.variable->variability == Variability::continuous;
}

void ContinuousGroups::connect(const ResolvedConnection& connection) {
  const auto from = places_[connection.from.instance];
  const auto to = places_[connection.to.instance];
  if (is_wire(connection)) {
    wires_[from.system].push_back(
        {.from = {from.member, connection.from.variable->value_reference},
         .to = {to.member, connection.to.variable->value_reference},
         .factor = connection.factor,
         .offset = connection.offset,
         .dependencies = dependencies_of(*system_.instances[connection.from.instance].model, *connection.from.variable),
         .from_name = system_.text(connection.from),
         .to_name = system_.text(connection.to)});
    return;
  }
  links_[from.system].push_back(link_of(connection, from.member, to.member));
}

}  // namespace mebots::master
