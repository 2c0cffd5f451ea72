// SPDX-License-Identifier: Apache-2.0
// Reads `stop_when` and `outcomes`.
#include "sections.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <variant>

namespace mebots::master::config {

namespace {

void read_comparison(Object& object, ConditionDescription& condition) {
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
}

struct QuantifierKey {
  const char* key;
  Quantifier quantifier;
};
constexpr QuantifierKey kQuantifiers[] = {
    {"all", Quantifier::all}, {"any", Quantifier::any}, {"count", Quantifier::count}};

void read_members(Object& object, const char* key, ConditionDescription& condition, const SystemDescription& system,
                  ReadMore read_more) {
  object.read(key, condition.members, data::list_of([&](const Node& element) {
                Object inner(element);
                auto member = read_condition(inner, system, read_more);
                inner.finish();
                return member;
              }));
  if (condition.members.empty() && object.sound())
    object.node().complain(ErrorCode::invalid_value, fmt::format("'{}' has no condition", key));
  if (condition.quantifier != Quantifier::count) return;
  read_comparison(object, condition);
  if (object.sound() && !std::holds_alternative<std::int64_t>(condition.value))
    object.node().complain(ErrorCode::wrong_type, "a count is compared with a whole number");
}

}  // namespace

ConditionDescription read_condition(Object& object, const SystemDescription& system, ReadMore read_more) {
  ConditionDescription condition;
  condition.place = object.node().place();
  for (const auto& [key, quantifier] : kQuantifiers) {
    if (!object.has(key)) continue;
    condition.quantifier = quantifier;
    read_members(object, key, condition, system, read_more);
    break;
  }
  if (condition.quantifier == Quantifier::none) {
    object.read("variable", condition.variable, variable_of(system));
    read_comparison(object, condition);
  }
  read_more(object, condition);
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
  auto condition = read_condition(
      object, system, [](Object& inner, ConditionDescription& one) { inner.read_if("ever", one.ever, &Node::flag); });
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
