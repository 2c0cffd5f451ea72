// SPDX-License-Identifier: Apache-2.0
// The sections `stop_when` and `outcomes`.
#include "config/conditions.hpp"

#include "reading.hpp"
#include "sections.hpp"

namespace mebots::master::config {

ConditionDescription read_condition(const JsonNode& node, const SystemDescription& system) {
  ConditionDescription condition;
  condition.place = node.place();
  condition.variable = variable_name(node.at("variable"), system);
  int comparisons = 0;
  const auto compare = [&](const char* key, Comparison comparison) {
    const auto value = node.find(key);
    if (!value) return;
    ++comparisons;
    condition.comparison = comparison;
    if (comparison != Comparison::equals) value->number();
    condition.value = written_value(*value);
  };
  compare("equals", Comparison::equals);
  compare("above", Comparison::above);
  compare("below", Comparison::below);
  if (comparisons != 1) node.fail("a condition needs exactly one of 'equals', 'above' and 'below'");
  return condition;
}

namespace {

ConditionDescription read_stop_condition(const JsonNode& node, const SystemDescription& system) {
  node.expect_keys({"variable", "equals", "above", "below", "for"});
  auto condition = read_condition(node, system);
  if (const auto duration = node.find("for")) condition.for_ns = duration_ns(*duration);
  return condition;
}

OutcomeDescription read_outcome(const JsonNode& node, const SystemDescription& system) {
  node.expect_keys({"outcome", "when"});
  OutcomeDescription outcome;
  outcome.outcome = readable_text(node.at("outcome"));
  if (const auto when = node.find("when")) {
    for (const auto& element : when->elements()) {
      element.expect_keys({"variable", "equals", "above", "below", "ever"});
      auto condition = read_condition(element, system);
      if (const auto ever = element.find("ever")) condition.ever = ever->boolean();
      outcome.when.push_back(std::move(condition));
    }
  }
  return outcome;
}

}  // namespace

void read_stop_when(const JsonNode& node, SystemDescription& system) {
  for (const auto& element : node.elements()) system.stop_when.push_back(read_stop_condition(element, system));
}

void read_outcomes(const JsonNode& node, SystemDescription& system) {
  for (const auto& element : node.elements()) system.outcomes.push_back(read_outcome(element, system));
}

}  // namespace mebots::master::config
