// SPDX-License-Identifier: Apache-2.0
#include "engine/discrete_links.hpp"

namespace mebots::master {

DiscreteLink link_of(const ResolvedConnection& connection, std::size_t from, std::size_t to) {
  DiscreteLink link{.from = from,
                    .to = to,
                    .from_kind = kind_of(connection.from.variable->type),
                    .to_kind = kind_of(connection.to.variable->type),
                    .from_reference = connection.from.variable->value_reference,
                    .to_reference = connection.to.variable->value_reference,
                    .factor = connection.factor,
                    .offset = connection.offset};
  for (const auto& pair : connection.map) link.map.emplace_back(pair.from, pair.to);
  return link;
}

}  // namespace mebots::master
