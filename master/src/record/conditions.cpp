// SPDX-License-Identifier: Apache-2.0
#include "record/conditions.hpp"

#include "base/time.hpp"
#include "model/value_kind.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace mebots::master {
namespace {

const char* sign(Comparison comparison) {
  switch (comparison) {
    case Comparison::equals:
      return "=";
    case Comparison::above:
      return ">";
    case Comparison::below:
      break;
  }
  return "<";
}

/// Returns a value as a config would contain it. Enumerations become the name of the item.
std::string shown(const modeldesc::ModelDescription& model, const modeldesc::Variable& variable,
                  const modeldesc::Value& value) {
  if (const auto* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
  const auto* type = model.type_definition(variable.declared_type);
  if (const auto* number = std::get_if<std::int64_t>(&value); number != nullptr && type != nullptr) {
    for (const auto& item : type->items) {
      if (item.value == *number) return item.name;
    }
  }
  const auto text = value_text(variable.type, value);
  return std::holds_alternative<std::string>(value) ? fmt::format("\"{}\"", text) : text;
}

/// True for types that support `above` and `below`.
bool is_ordered(modeldesc::Type type) {
  return fmi::is_float(type) || (kind_of(type) == ValueKind::integer && type != modeldesc::Type::enumeration);
}

}  // namespace

Condition::Condition(const ResolvedSystem& system, Ensemble& ensemble, const ConditionDescription& description)
    : ensemble_(&ensemble),
      quantifier_(description.quantifier),
      ever_(description.ever),
      comparison_(description.comparison) {
  if (quantifier_ == Quantifier::none) {
    compare_variable(system, ensemble, description);
  } else {
    count_members(system, ensemble, description);
  }
}

void Condition::compare_variable(const ResolvedSystem& system, Ensemble& ensemble,
                                 const ConditionDescription& description) {
  const auto resolved = system.find(description.variable, description.place + "/variable");
  const auto& variable = *resolved.variable;
  const auto& model = *system.instances[resolved.instance].model;
  std::string value;
  if (comparison_ == Comparison::equals) {
    const auto typed = typed_value(model, variable, description.value, description.place + "/equals");
    if (const auto* number = std::get_if<double>(&typed)) number_ = *number;
    if (const auto* number = std::get_if<std::int64_t>(&typed)) whole_ = *number;
    if (const auto* flag = std::get_if<bool>(&typed)) number_ = *flag ? 1 : 0;
    if (const auto* text = std::get_if<std::string>(&typed)) string_ = *text;
    value = shown(model, variable, typed);
  } else {
    if (!is_ordered(variable.type)) {
      throw InputError(ErrorCode::wrong_type,
                       fmt::format("{}: '{}' is of type {}, which has no order; use 'equals'", description.place,
                                   description.variable.text(), modeldesc::to_string(variable.type)));
    }
    const auto* integer = std::get_if<std::int64_t>(&description.value);
    number_ = integer != nullptr ? static_cast<double>(*integer) : std::get<double>(description.value);
    value = fmt::format("{}", number_);
  }
  signal_ = ensemble.watch(resolved);
  type_ = variable.type;
  text_ = fmt::format("{} {} {}", description.variable.text(), sign(comparison_), value);
}

void Condition::count_members(const ResolvedSystem& system, Ensemble& ensemble,
                              const ConditionDescription& description) {
  for (const auto& member : description.members) members_.emplace_back(system, ensemble, member);
  const auto of =
      fmt::format("of {} ({}{})", members_.size(), members_.front().text(), members_.size() > 1 ? ", ..." : "");
  if (quantifier_ != Quantifier::count) {
    text_ = fmt::format("{} {}", quantifier_ == Quantifier::all ? "all" : "any", of);
    return;
  }
  number_ = static_cast<double>(std::get<std::int64_t>(description.value));
  text_ = fmt::format("count {} {} {}", of, sign(comparison_), number_);
}

bool Condition::holds_now() const {
  if (quantifier_ == Quantifier::all) return std::ranges::all_of(members_, &Condition::holds);
  if (quantifier_ == Quantifier::any) return std::ranges::any_of(members_, &Condition::holds);
  if (quantifier_ == Quantifier::count)
    return compares(static_cast<double>(std::ranges::count_if(members_, &Condition::holds)));
  if (signal_.kind == ValueKind::string || signal_.kind == ValueKind::binary)
    return ensemble_->string(signal_) == string_;
  if (signal_.kind == ValueKind::real) return compares(ensemble_->real(signal_));
  const auto value = ensemble_->integer(signal_);
  if (signal_.kind == ValueKind::boolean) return compares(value == 0 ? 0 : 1);
  if (comparison_ == Comparison::equals) return value == whole_;  // exact for integers of 64 bits
  return compares(number_of(type_, value));
}

bool Condition::compares(double value) const {
  switch (comparison_) {
    case Comparison::equals:
      return value == number_;
    case Comparison::above:
      return value > number_;
    case Comparison::below:
      break;
  }
  return value < number_;
}

void Condition::note_point() {
  for (auto& member : members_) member.note_point();
  if (ever_ && !held_) held_ = holds_now();
}

void Condition::visit(state::Visitor& v) {
  v("held", held_);
  v("members", std::span(members_));
}

StopConditions::StopConditions(const ResolvedSystem& system, Ensemble& ensemble) : grid_(system.description->grid()) {
  for (const auto& description : system.description->stop_when) {
    watches_.push_back({Condition(system, ensemble, description), description.for_ns});
  }
}

std::optional<std::string> StopConditions::reached(const Point& point) {
  std::optional<std::string> wish;
  for (auto& watch : watches_) {
    if (!watch.condition.holds()) {
      watch.since_ns.reset();
      continue;
    }
    if (!watch.since_ns) watch.since_ns = point.time_ns;
    if (wish || !grid_.has_passed(*watch.since_ns, point.time_ns, watch.for_ns)) continue;
    wish = fmt::format("{} at {} s", watch.condition.text(), to_seconds(*watch.since_ns));
    if (watch.for_ns > 0) *wish += fmt::format(", held for {} s", to_seconds(watch.for_ns));
  }
  return wish;
}

void StopConditions::visit(state::Visitor& v) {
  v("watches", std::span(watches_));
}

Outcomes::Outcomes(const ResolvedSystem& system, Ensemble& ensemble) {
  for (const auto& description : system.description->outcomes) {
    Rule rule{description.outcome, {}};
    for (const auto& condition : description.when) rule.when.emplace_back(system, ensemble, condition);
    rules_.push_back(std::move(rule));
  }
}

std::optional<std::string> Outcomes::reached(const Point& /*point*/) {
  for (auto& rule : rules_) {
    for (auto& condition : rule.when) condition.note_point();
  }
  return std::nullopt;
}

std::string Outcomes::outcome() const {
  for (const auto& rule : rules_) {
    if (std::ranges::all_of(rule.when, &Condition::holds)) return rule.outcome;
  }
  return "completed";
}

void Outcomes::visit(state::Visitor& v) {
  v("rules", std::span(rules_));
}

}  // namespace mebots::master
