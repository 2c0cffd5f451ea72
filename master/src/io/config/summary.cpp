// SPDX-License-Identifier: Apache-2.0
// The section `summary`: labels, which may be nested, to variables, or to variables with conditions.
#include "conditions.hpp"
#include "reading.hpp"
#include "sections.hpp"

namespace mebots::master::config {
namespace {

ConditionDescription read_final_condition(const Node& node, const SystemDescription& system) {
  Object object(node);
  auto condition = read_condition(object, system);
  object.finish();
  return condition;
}

/// A value that means something only when the run came to a point where it was measured.
SummaryEntry read_conditional(const Node& node, const std::vector<std::string>& path, const SystemDescription& system) {
  Object object(node);
  SummaryEntry entry{path, {}, {}, node.place()};
  object.read("variable", entry.variable, variable_of(system));
  object.read("when", entry.when,
              data::list_of([&](const Node& element) { return read_final_condition(element, system); }));
  object.finish();
  return entry;
}

bool is_conditional(const Node& node) {
  const auto when = node.find("when");
  return node.has("variable") && when && when->is(data::Kind::list);
}

// Recursive: the document bounds the depth.
void read_labels(const Node& node, const std::vector<std::string>& path, SystemDescription& system) {
  for (const auto& [label, value] : node.members()) {
    value.attempt([&, &label = label, &value = value] {
      auto inner = path;
      inner.push_back(label);
      if (!value.is(data::Kind::object)) {
        auto name = variable_name(value, system);
        system.summary.push_back({std::move(inner), std::move(name), {}, value.place()});
      } else if (is_conditional(value)) {
        system.summary.push_back(read_conditional(value, inner, system));
      } else {
        read_labels(value, inner, system);
      }
    });
  }
}

}  // namespace

void read_summary(const Node& node, SystemDescription& system) {
  read_labels(node, {}, system);
}

}  // namespace mebots::master::config
