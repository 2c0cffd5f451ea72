// SPDX-License-Identifier: Apache-2.0
// The section `connections`.
#include "reading.hpp"
#include "sections.hpp"

namespace mebots::master::config {

void read_connections(const JsonNode& node, SystemDescription& system) {
  for (const auto& element : node.elements()) {
    element.expect_keys({"from", "to"});
    const auto from = variable_name(element.at("from"), system);
    system.connections.push_back({from, variable_name(element.at("to"), system), element.place()});
  }
}

}  // namespace mebots::master::config
