// SPDX-License-Identifier: Apache-2.0
// Determines which instances step together from tick to tick, and which connections transfer values at ticks.
#include "resolve/clock_groups.hpp"

#include "resolve/instance_groups.hpp"

#include "mebots/assert.hpp"

#include <algorithm>
#include <iterator>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Type;

/// Returns the connections of clocks and clocked variables between these members.
std::vector<ResolvedConnection> connections_within(const ResolvedSystem& system,
                                                   const std::vector<std::size_t>& members) {
  std::vector<ResolvedConnection> found;
  std::ranges::copy_if(system.connections, std::back_inserter(found), [&](const auto& connection) {
    if (!is_carried_by_ticks(connection) || !std::ranges::binary_search(members, connection.from.instance))
      return false;
    MEBOTS_ASSERT(std::ranges::binary_search(members, connection.to.instance));
    return true;
  });
  return found;
}

}  // namespace

bool is_carried_by_ticks(const ResolvedConnection& connection) {
  return is_clocked(*connection.from.variable) && is_clocked(*connection.to.variable);
}

bool has_ticking_clocks(const modeldesc::ModelDescription& model, FmuKind kind) {
  if (!model.is_fmi3() || (kind == FmuKind::co_simulation && !model.co_simulation->has_event_mode)) return false;
  return std::ranges::any_of(model.variables, [](const auto& variable) {
    return variable.type == Type::clock && variable.causality != Causality::local;
  });
}

void resolve_clock_groups(ResolvedSystem& system) {
  InstanceGroups groups(system.instances.size());
  for (const auto& connection : system.connections) {
    if (is_carried_by_ticks(connection)) groups.join(connection.from.instance, connection.to.instance);
  }
  const auto is_member = [&](std::size_t i) {
    return system.instances[i].clocks_tick && system.instances[i].kind == FmuKind::co_simulation;
  };
  for (auto& members : groups.of(is_member)) {
    check_members(system, members, {.member = "has clocks", .group = "group of clocks"});
    auto connections = connections_within(system, members);
    system.clock_groups.push_back({.members = std::move(members), .connections = std::move(connections)});
  }
  for (auto& continuous : system.continuous_systems) {
    continuous.clock_connections = connections_within(system, continuous.members);
  }
  std::erase_if(system.connections, is_carried_by_ticks);
}

}  // namespace mebots::master
