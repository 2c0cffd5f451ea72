// SPDX-License-Identifier: Apache-2.0
// Reads the sections `stop_when` and `outcomes`.
#include "sections.hpp"

namespace mebots::master::config {

ConditionDescription read_condition(Object& object, const SystemDescription& system) {
  ConditionDescription condition;
  condition.place = object.node().place();
  object.read("variable", condition.variable, variable_of(system));
  int comparisons = 0;
  const auto compare = [&](const char* key, Comparison comparison) {
    if (object.has(key)) {
      ++comparisons;
      condition.comparison = comparison;
    }
    object.read_if(key, condition.value, [&](const Node& value) {
      if (comparison != Comparison::equals) static_cast<void>(value.number());
      return written_value(value);
    });
  };
  compare("equals", Comparison::equals);
  compare("above", Comparison::above);
  compare("below", Comparison::below);
  if (comparisons != 1) {
    object.node().complain(ErrorCode::invalid_value, "a condition needs exactly one of 'equals', 'above' and 'below'");
  }
  return condition;
}

ConditionDescription read_lasting_condition(const Node& node, const SystemDescription& system) {
  Object object(node);
  auto condition = read_condition(object, system);
  object.read_if("for", condition.for_ns, &duration_ns);
  object.finish();
  return condition;
}

namespace {

ConditionDescription read_outcome_condition(const Node& node, const SystemDescription& system) {
  Object object(node);
  auto condition = read_condition(object, system);
  object.read_if("ever", condition.ever, &Node::flag);
  object.finish();
  return condition;
}

OutcomeDescription read_outcome(const Node& node, const SystemDescription& system) {
  Object object(node);
  OutcomeDescription outcome;
  object.read("outcome", outcome.outcome, &Node::readable_text);
  object.read_if("when", outcome.when,
                 data::list_of([&](const Node& element) { return read_outcome_condition(element, system); }));
  object.finish();
  return outcome;
}

}  // namespace

void read_stop_when(const Node& node, SystemDescription& system) {
  system.stop_when = data::list_of([&](const Node& element) { return read_lasting_condition(element, system); })(node);
}

void read_outcomes(const Node& node, SystemDescription& system) {
  system.outcomes = data::list_of([&](const Node& element) { return read_outcome(element, system); })(node);
}

}  // namespace mebots::master::config
