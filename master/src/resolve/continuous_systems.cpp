// SPDX-License-Identifier: Apache-2.0
// Determines which model exchange instances one solver integrates, and which connections it evaluates.
#include "model/resolved_system.hpp"
#include "resolve/clock_groups.hpp"
#include "resolve/instance_groups.hpp"
#include "resolve/signal_coverage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace mebots::master {
namespace {

using modeldesc::Type;
using modeldesc::Variability;

/// Returns the variables that a scenario or a signal file sets.
std::set<ResolvedVariable> overridden_variables(const ResolvedSystem& system) {
  std::set<ResolvedVariable> variables;
  for (const auto& [input, signal] : system.inputs) variables.insert(input);
  for (const auto& entry : system.description->scenario) {
    variables.insert(system.find(entry.variable, entry.place));
  }
  return variables;
}

bool is_real(const ResolvedVariable& variable) {
  return kind_of(variable.variable->type) == ValueKind::real;
}

class Grouping {
 public:
  explicit Grouping(ResolvedSystem& system) : system_(system) {}

  void run() {
    mark_inner_connections();
    InstanceGroups groups(system_.instances.size());
    for (const auto& connection : system_.connections) {
      if (connection.inner) groups.join(connection.from.instance, connection.to.instance);
    }
    const auto is_member = [&](std::size_t i) { return system_.instances[i].kind == FmuKind::model_exchange; };
    for (auto& members : groups.of(is_member)) {
      check_members(system_, members, {.member = "is of model exchange", .group = "continuous system"});
      const auto* solver = solver_of(members);
      system_.continuous_systems.push_back({.members = std::move(members), .solver = solver});
    }
  }

 private:
  /// Marks the inner connections. Both ends of an inner connection are variables of model exchange instances and have
  /// no override. An input with an override is constant between communication points, so that its connection cannot be
  /// inner. In a sum, either all connections are inner or none.
  void mark_inner_connections() {
    const auto overridden = overridden_variables(system_);
    std::map<ResolvedVariable, bool> inner_sums;
    for (auto& connection : system_.connections) {
      const auto is_exchanged = [&](const ResolvedVariable& end) {
        return system_.instances[end.instance].kind == FmuKind::model_exchange && !overridden.contains(end);
      };
      connection.inner = is_exchanged(connection.from) && is_exchanged(connection.to) && !connection.pointer;
      const bool is_exchange = system_.instances[connection.from.instance].kind == FmuKind::model_exchange;
      connection.inner |= is_exchange && is_carried_by_ticks(connection);
      if (!connection.sum) continue;
      auto& whole = inner_sums.try_emplace(connection.to, true).first->second;
      whole &= connection.inner && is_real(connection.from) && !is_clocked(*connection.from.variable) &&
               connection.to.variable->variability == Variability::continuous;
    }
    for (auto& connection : system_.connections) {
      if (connection.sum) connection.inner = inner_sums.at(connection.to);
    }
  }

  /// Returns the solver settings of a member or, if no member has any, those of the whole system. Throws InputError if
  /// several members have settings.
  const SolverDescription* solver_of(const std::vector<std::size_t>& members) const {
    const InstanceDescription* namer = nullptr;
    for (const auto member : members) {
      const auto& description = *system_.instances[member].description;
      if (!description.solver) continue;
      if (namer != nullptr) {
        refuse_key(
            system_, member, "solver",
            fmt::format("'{}' and '{}' are in one continuous system, which has one solver; keep one of the two entries",
                        namer->name, description.name));
      }
      namer = &description;
    }
    return namer != nullptr ? &*namer->solver : &system_.description->solver;
  }

  ResolvedSystem& system_;
};

}  // namespace

void resolve_continuous_systems(ResolvedSystem& system) {
  const bool any = std::ranges::any_of(system.instances,
                                       [](const auto& instance) { return instance.kind == FmuKind::model_exchange; });
  if (any) Grouping(system).run();
}

}  // namespace mebots::master
