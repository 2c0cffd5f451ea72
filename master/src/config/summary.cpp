// SPDX-License-Identifier: Apache-2.0
// The section `summary`: labels, which may be nested, to variables, or to variables with conditions.
#include "config/conditions.hpp"
#include "reading.hpp"
#include "sections.hpp"

namespace mebots::master::config {
namespace {

/// A value that means something only when the run came to a point where it was measured.
SummaryEntry read_conditional(const JsonNode& node, const std::vector<std::string>& path,
                              const SystemDescription& system) {
  node.expect_keys({"variable", "when"});
  SummaryEntry entry{path, variable_name(node.at("variable"), system), {}, node.place()};
  for (const auto& element : node.at("when").elements()) {
    element.expect_keys({"variable", "equals", "above", "below"});
    entry.when.push_back(read_condition(element, system));
  }
  return entry;
}

// Recursive: parse_json bounds the depth.
void read_labels(const JsonNode& node, const std::vector<std::string>& path, SystemDescription& system) {
  for (const auto& [label, value] : node.members()) {
    auto inner = path;
    inner.push_back(label);
    if (!value.value().is_object()) {
      system.summary.push_back({inner, variable_name(value, system), {}, value.place()});
    } else if (value.has("variable") && value.has("when") && value.at("when").value().is_array()) {
      system.summary.push_back(read_conditional(value, inner, system));
    } else {
      read_labels(value, inner, system);
    }
  }
}

}  // namespace

void read_summary(const JsonNode& node, SystemDescription& system) {
  read_labels(node, {}, system);
}

}  // namespace mebots::master::config
