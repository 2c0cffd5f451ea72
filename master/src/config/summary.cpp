// SPDX-License-Identifier: Apache-2.0
// The section `summary`: labels, which may be nested, to variables.
#include "reading.hpp"
#include "sections.hpp"

namespace mebots::master::config {
namespace {

// Recursive: parse_json bounds the depth.
void read_labels(const JsonNode& node, const std::vector<std::string>& path, SystemDescription& system) {
  for (const auto& [label, value] : node.members()) {
    auto inner = path;
    inner.push_back(label);
    if (value.value().is_object()) {
      read_labels(value, inner, system);
    } else {
      system.summary.push_back({inner, variable_name(value, system), value.place()});
    }
  }
}

}  // namespace

void read_summary(const JsonNode& node, SystemDescription& system) {
  read_labels(node, {}, system);
}

}  // namespace mebots::master::config
