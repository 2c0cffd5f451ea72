// SPDX-License-Identifier: Apache-2.0
// The section `log`.
#include "reading.hpp"
#include "sections.hpp"

namespace mebots::master::config {

void read_log(const Node& node, SystemDescription& system) {
  for (const auto& [name, categories] : node.members()) {
    categories.attempt([&, &name = name, &categories = categories] {
      system.log.push_back({instance_name(name, categories, system), data::list_of(&Node::readable_text)(categories)});
    });
  }
}

}  // namespace mebots::master::config
