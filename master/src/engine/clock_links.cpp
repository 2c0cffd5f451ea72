// SPDX-License-Identifier: Apache-2.0
#include "engine/clock_links.hpp"

#include "engine/discrete_links.hpp"

namespace mebots::master {

ClockLinks clock_links(const std::vector<ResolvedConnection>& connections,
                       const std::function<std::size_t(std::size_t instance)>& member_of) {
  ClockLinks links;
  for (const auto& connection : connections) {
    const auto& from = *connection.from.variable;
    const auto& to = *connection.to.variable;
    const auto from_member = member_of(connection.from.instance);
    const auto to_member = member_of(connection.to.instance);
    if (from.type == modeldesc::Type::clock) {
      links.clocks.push_back({from_member, to_member, from.value_reference, to.value_reference});
    } else {
      links.values.push_back({link_of(connection, from_member, to_member), from.fmi3->clocks, to.fmi3->clocks});
    }
  }
  return links;
}

}  // namespace mebots::master
