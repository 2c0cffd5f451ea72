// SPDX-License-Identifier: Apache-2.0
#include "record/coupling.hpp"

#include "base/time.hpp"
#include "mebots/assert.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mebots::master {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

double step_for(double relative, double limit, int order, double step_s) {
  MEBOTS_ASSERT(relative > limit && limit > 0 && order > 0);
  const double wanted_s = step_s * std::pow(limit / relative, 1.0 / order);
  const double power = std::pow(10, std::floor(std::log10(wanted_s)));
  for (const double digit : {5.0, 2.0}) {
    if (digit * power <= wanted_s) return digit * power;
  }
  return power;
}

InputDeviation::InputDeviation(const ResolvedSystem& system, Ensemble& ensemble, const ResolvedConnection& connection)
    : input_(system.text(connection.to)),
      source_(system.text(connection.from)),
      unit_(connection.to.variable->unit),
      coupled_(ensemble, connection) {}

void InputDeviation::take(double deviation, std::int64_t time_ns) {
  squares_ += deviation * deviation;
  ++count_;
  if (std::abs(deviation) <= largest_) return;
  largest_ = std::abs(deviation);
  largest_at_ns_ = time_ns;
}

void InputDeviation::reached(std::int64_t time_ns, const TimeGrid& grid) {
  if (!coupled_.is_reached(time_ns)) return;
  const double value = coupled_.value();
  if (!last_time_ns_) {
    least_ = most_ = value;
  } else {
    const auto start_ns = *coupled_.input().start_ns;
    if (start_ns == *last_time_ns_) take(*coupled_.input().value - last_value_, start_ns);
    take(coupled_.input_at(time_ns, grid) - value, time_ns);
    least_ = std::min(least_, value);
    most_ = std::max(most_, value);
  }
  last_value_ = value;
  last_time_ns_ = time_ns;
}

double InputDeviation::relative() const {
  const double range = most_ - least_;
  return range > 0 ? std::sqrt(squares_ / static_cast<double>(count_)) / range : 0;
}

void InputDeviation::visit(state::Visitor& v) {
  v("last_value", last_value_);
  v("last_time_ns", last_time_ns_);
  v("least", least_);
  v("most", most_);
  v("squares", squares_);
  v("count", count_);
  v("largest", largest_);
  v("largest_at_ns", largest_at_ns_);
}

Json InputDeviation::json() const {
  Json json = {{"from", source_}, {"largest", largest_}, {"largest_at", to_seconds(largest_at_ns_)}};
  json["rms"] = count_ > 0 ? std::sqrt(squares_ / static_cast<double>(count_)) : 0.0;
  json["range"] = most_ - least_;
  json["relative"] = relative();
  if (!unit_.empty()) json["unit"] = unit_;
  return json;
}

void BondEnergy::reached(const Point& point, const TimeGrid& grid) {
  if (const auto energy = bond_.energy(point, grid)) {
    made_ += energy->made;
    passed_ += energy->passed;
    largest_ = std::max(largest_, std::abs(made_));
  }
  bond_.advance(point, grid);
}

void BondEnergy::visit(state::Visitor& v) {
  v("bond", bond_);
  v("made", made_);
  v("passed", passed_);
  v("largest", largest_);
}

Json BondEnergy::json() const {
  Json json = {{"made", made_}, {"most_made", largest_}, {"passed", passed_}, {"relative", relative()}};
  json["limit"] = description().limit;
  if (!bond_.unit().empty()) json["unit"] = bond_.unit();
  return json;
}

Coupling::Coupling(const ResolvedSystem& system, Ensemble& ensemble)
    : system_(system.description), grid_(system.description->grid()) {
  MEBOTS_ASSERT(system.description->coupling.has_value());
  const auto& description = *system.description->coupling;
  input_limit_ = description.input_limit;
  for (const auto& connection : system.connections) {
    if (connection.is_continuous()) inputs_.emplace_back(system, ensemble, connection);
  }
  for (const auto& bond : description.bonds) bonds_.emplace_back(system, ensemble, bond);
}

std::optional<std::string> Coupling::reached(const Point& point) {
  for (auto& input : inputs_) input.reached(point.time_ns, grid_);
  for (auto& bond : bonds_) bond.reached(point, grid_);
  return std::nullopt;
}

void Coupling::visit(state::Visitor& v) {
  v("inputs", std::span(inputs_));
  v("bonds", std::span(bonds_));
}

std::string Coupling::advice(double relative, double limit, int order) const {
  if (system_->step_control) return "smaller tolerances or a smaller \"max_step\" in \"step_control\" would suffice";
  const double step_s = to_seconds(system_->step);
  return fmt::format("a communication step of {} s instead of {} s would suffice",
                     step_for(relative, limit, order, step_s), step_s);
}

std::vector<std::string> Coupling::warnings() const {
  std::vector<std::string> warnings;
  for (const auto& bond : bonds_) {
    const auto& name = bond.description().name;
    const double limit = bond.description().limit;
    if (bond.relative() <= limit) continue;
    warnings.push_back(fmt::format(
        "the coupling {} energy in the bond '{}': {:.2g} of the transferred energy, more than its limit {:g}; {}",
        bond.made() > 0 ? "made" : "lost", name, bond.relative(), limit, advice(bond.relative(), limit, bond.order())));
  }
  for (const auto& input : inputs_) {
    if (!input_limit_ || input.relative() <= *input_limit_) continue;
    warnings.push_back(fmt::format(
        "the input {} differed from its source by {:.2g} of its range (root mean square), more than the limit {:g}; {}",
        input.input(), input.relative(), *input_limit_, advice(input.relative(), *input_limit_, input.order())));
  }
  return warnings;
}

Json Coupling::json() const {
  Json json;
  auto& inputs = json["inputs"] = Json::object();
  for (const auto& input : inputs_) inputs[input.input()] = input.json();
  for (const auto& bond : bonds_) json["bonds"][bond.description().name] = bond.json();
  return json;
}

}  // namespace mebots::master
