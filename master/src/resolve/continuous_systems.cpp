// SPDX-License-Identifier: Apache-2.0
// Which instances of model exchange one solver integrates, and which connections it evaluates.
#include "resolve/signal_coverage.hpp"

#include "base/time.hpp"
#include "mebots/input_error.hpp"
#include "model/resolved_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

namespace mebots::master {
namespace {

using modeldesc::Type;
using modeldesc::Variability;

/// Variables that a scenario or a file of signals changes.
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
  explicit Grouping(ResolvedSystem& system) : system_(system), leaders_(system.instances.size()) {
    std::iota(leaders_.begin(), leaders_.end(), std::size_t{0});
  }

  void run() {
    mark_inner_connections();
    for (auto& connection : system_.connections) {
      if (connection.inner) join(connection.from.instance, connection.to.instance);
    }
    std::map<std::size_t, std::vector<std::size_t>> groups;
    for (std::size_t i = 0; i < leaders_.size(); ++i) {
      if (system_.instances[i].kind == FmuKind::model_exchange) groups[leader(i)].push_back(i);
    }
    for (auto& [first, members] : groups) {
      for (const auto member : members) check_member(member, members);
      const auto* solver = solver_of(members);
      system_.continuous_systems.push_back({.members = std::move(members), .solver = solver});
    }
  }

 private:
  std::size_t leader(std::size_t instance) {
    while (leaders_[instance] != instance) instance = leaders_[instance];
    return instance;
  }
  void join(std::size_t one, std::size_t other) {
    const auto [first, second] = std::minmax({leader(one), leader(other)});
    leaders_[second] = first;
  }

  /// A connection is inner if both ends are of model exchange and no override acts on them. An override acts at
  /// communication points, so it holds the input in between. A sum must be evaluated as a whole.
  void mark_inner_connections() {
    const auto overridden = overridden_variables(system_);
    std::map<ResolvedVariable, bool> inner_sums;
    for (auto& connection : system_.connections) {
      const auto is_exchanged = [&](const ResolvedVariable& end) {
        return system_.instances[end.instance].kind == FmuKind::model_exchange && !overridden.contains(end);
      };
      connection.inner = is_exchanged(connection.from) && is_exchanged(connection.to) && !connection.pointer;
      if (!connection.sum) continue;
      auto& whole = inner_sums.try_emplace(connection.to, true).first->second;
      whole &= connection.inner && is_real(connection.from) &&
               connection.to.variable->variability == Variability::continuous;
    }
    for (auto& connection : system_.connections) {
      if (connection.sum) connection.inner = inner_sums.at(connection.to);
    }
  }

  [[noreturn]] void refuse(std::size_t instance, std::string_view key, const std::string& what) const {
    throw InputError(ErrorCode::invalid_value,
                     fmt::format("{}/{}: {}", system_.instances[instance].description->place, key, what));
  }

  void check_member(std::size_t member, const std::vector<std::size_t>& members) const {
    const auto& instance = system_.instances[member];
    const auto& description = *instance.description;
    const auto& first = *system_.instances[members.front()].description;
    if (description.divide_discarded) {
      refuse(member, "on_discard", "an instance of model exchange has no steps that it could discard");
    }
    if (instance.isolation.alone()) {
      refuse(member, "process",
             fmt::format("'{}' is of model exchange, which runs in the master's process only. Set \"kind\": "
                         "\"co_simulation\" if its FMU offers it, or \"process\": \"shared\"",
                         description.name));
    }
    if (description.steps != first.steps) {
      refuse(member, "step",
             fmt::format("'{}' and '{}' are in one continuous system, so they need the same step, and theirs are {} s "
                         "and {} s",
                         first.name, description.name, time_text(system_.description->step_of(first)),
                         time_text(system_.description->step_of(description))));
    }
    if (instance.isolation.go_on_without && members.size() > 1) {
      refuse(member, "on_failure",
             fmt::format("'{}' is in a continuous system with others, which cannot continue without it",
                         description.name));
    }
  }

  /// The one solver that members name, else that of the whole system.
  const SolverDescription* solver_of(const std::vector<std::size_t>& members) const {
    const InstanceDescription* namer = nullptr;
    for (const auto member : members) {
      const auto& description = *system_.instances[member].description;
      if (!description.solver) continue;
      if (namer != nullptr) {
        refuse(member, "solver",
               fmt::format("'{}' and '{}' are in one continuous system, which has one solver; keep one of both",
                           namer->name, description.name));
      }
      namer = &description;
    }
    return namer != nullptr ? &*namer->solver : &system_.description->solver;
  }

  ResolvedSystem& system_;
  std::vector<std::size_t> leaders_;  // of each instance, an earlier one of its system or itself
};

}  // namespace

void resolve_continuous_systems(ResolvedSystem& system) {
  const bool any = std::ranges::any_of(system.instances,
                                       [](const auto& instance) { return instance.kind == FmuKind::model_exchange; });
  if (any) Grouping(system).run();
}

}  // namespace mebots::master
