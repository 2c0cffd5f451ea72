// SPDX-License-Identifier: Apache-2.0
// Determines which instances step together from tick to tick of their clocks, and which connections transfer values at
// ticks.
#include "resolve/clock_groups.hpp"

#include "resolve/instance_groups.hpp"

#include <algorithm>
#include <iterator>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Type;

bool is_carried_by_ticks(const ResolvedConnection& connection) {
  return is_clocked(*connection.from.variable) && is_clocked(*connection.to.variable);
}

}  // namespace

bool has_ticking_clocks(const modeldesc::ModelDescription& model, FmuKind kind) {
  if (kind != FmuKind::co_simulation || !model.is_fmi3() || !model.co_simulation->has_event_mode) return false;
  return std::ranges::any_of(model.variables, [](const auto& variable) {
    return variable.type == Type::clock && variable.causality != Causality::local;
  });
}

void resolve_clock_groups(ResolvedSystem& system) {
  InstanceGroups groups(system.instances.size());
  for (const auto& connection : system.connections) {
    if (is_carried_by_ticks(connection)) groups.join(connection.from.instance, connection.to.instance);
  }
  for (auto& members : groups.of([&](std::size_t i) { return system.instances[i].clocks_tick; })) {
    check_members(system, members, {.member = "has clocks", .group = "group of clocks"});
    ResolvedClockGroup group;
    for (const auto& connection : system.connections) {
      const bool is_inside = std::ranges::binary_search(members, connection.from.instance);
      if (is_inside && is_carried_by_ticks(connection)) group.connections.push_back(connection);
    }
    group.members = std::move(members);
    system.clock_groups.push_back(std::move(group));
  }
  std::erase_if(system.connections, is_carried_by_ticks);
}

}  // namespace mebots::master
