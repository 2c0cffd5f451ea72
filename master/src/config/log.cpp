// SPDX-License-Identifier: Apache-2.0
// The section `log`.
#include "reading.hpp"
#include "sections.hpp"

namespace mebots::master::config {

void read_log(const JsonNode& node, SystemDescription& system) {
  for (const auto& [instance, categories] : node.members()) {
    LogDescription log{instance_name(instance, categories, system), {}};
    for (const auto& element : categories.elements()) log.categories.push_back(readable_text(element));
    system.log.push_back(std::move(log));
  }
}

}  // namespace mebots::master::config
