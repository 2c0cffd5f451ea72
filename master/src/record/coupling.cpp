// SPDX-License-Identifier: Apache-2.0
#include "record/coupling.hpp"

#include "base/time.hpp"
#include "mebots/assert.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace mebots::master {
namespace {

using Json = nlohmann::ordered_json;
using modeldesc::Type;
using modeldesc::Variability;

/// 1 / number: of small ones without a division, which is most of what an integral costs.
double reciprocal(std::size_t number) {
  constexpr std::array kKnown = {0.0, 1.0, 1.0 / 2, 1.0 / 3, 1.0 / 4, 1.0 / 5, 1.0 / 6, 1.0 / 7, 1.0 / 8};
  return number < kKnown.size() ? kKnown[number] : 1 / static_cast<double>(number);
}

/// value + d_1 tau + d_2 tau^2 / 2! + ..., from the highest order down.
double at(const InputCourse& course, double tau_s) {
  double sum = 0;
  for (auto order = course.derivatives.size(); order > 0; --order) {
    sum = (sum + course.derivatives[order - 1]) * tau_s * reciprocal(order);
  }
  return *course.value + sum;
}

/// The integral of input times output over a step: the sum of a_i d_j / j! tau^(i + j + 1) / (i + j + 1).
double product_integral(const InputCourse& input, double scale, double offset, const std::array<double, 3>& output,
                        double length_s) {
  double integral = 0;
  double coefficient = *input.value * scale + offset;  // d_j / j! tau^j
  for (std::size_t j = 0; j <= input.derivatives.size(); ++j) {
    if (j > 0) coefficient = scale * input.derivatives[j - 1];
    for (std::size_t k = 1; k <= j; ++k) coefficient *= length_s * reciprocal(k);
    double power = length_s;  // tau^(i + 1)
    for (std::size_t i = 0; i < output.size(); ++i) {
      integral += output[i] * coefficient * power * reciprocal(i + j + 1);
      power *= length_s;
    }
  }
  return integral;
}

/// The integral of the product of two outputs over a step.
double product_integral(const std::array<double, 3>& one, const std::array<double, 3>& other, double length_s) {
  // By powers of tau, the highest first: c_n = sum over i + j = n of a_i b_j, each tau^(n + 1) / (n + 1).
  double integral = 0;
  for (std::size_t n = one.size() + other.size() - 1; n-- > 0;) {
    double coefficient = 0;
    for (std::size_t i = n < other.size() ? 0 : n - other.size() + 1; i <= n && i < one.size(); ++i) {
      coefficient += one[i] * other[n - i];
    }
    integral = (integral + coefficient * reciprocal(n + 1)) * length_s;
  }
  return integral;
}

bool is_measured(const ResolvedConnection& connection) {
  const auto continuous = [](const ResolvedVariable& variable) {
    return variable.variable->type == Type::real && variable.variable->variability == Variability::continuous;
  };
  return !connection.inner && !connection.sum && continuous(connection.from) && continuous(connection.to);
}

std::string product_text(const std::string& one, const std::string& other) {
  return one.empty() || other.empty() ? "" : fmt::format("{}.{}.s", one, other);
}

std::string advice(double relative, double limit, int order, double step_s) {
  return fmt::format("a communication step of {} s instead of {} s would do", step_for(relative, limit, order, step_s),
                     step_s);
}

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

std::array<double, 3> OutputCourse::coefficients(double length_s) const {
  const double rise = last - first;
  const double earlier_rise = before ? first - *before : rise;
  return {first, (rise + earlier_rise) / (2 * length_s), (rise - earlier_rise) / (2 * length_s * length_s)};
}

InputDeviation::InputDeviation(const ResolvedSystem& system, Ensemble& ensemble, const ResolvedConnection& connection)
    : input_(system.text(connection.to)),
      source_(system.text(connection.from)),
      unit_(connection.to.variable->unit),
      ensemble_(&ensemble),
      output_(ensemble.watch(connection.from)),
      factor_(connection.factor),
      offset_(connection.offset),
      course_(ensemble.course_of(connection.to)) {}

void InputDeviation::take(double deviation, std::int64_t time_ns) {
  squares_ += deviation * deviation;
  ++count_;
  if (std::abs(deviation) <= largest_) return;
  largest_ = std::abs(deviation);
  largest_at_ns_ = time_ns;
}

void InputDeviation::reached(std::int64_t time_ns, const TimeGrid& grid) {
  // The source may be in the middle of a longer step.
  if (ensemble_->outputs_time_ns(output_.instance) != time_ns) return;
  const double value = factor_ * ensemble_->real(output_) + offset_;
  if (!last_time_ns_) {
    least_ = most_ = value;
  } else {
    const auto start_ns = *course_.start_ns;
    if (start_ns == *last_time_ns_) take(*course_.value - last_value_, start_ns);
    take(at(course_, grid.length_s(start_ns, time_ns)) - value, time_ns);
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

void BondEnergy::Half::visit(state::Visitor& v) {
  v("first", step.first);
  auto before = step.before.value_or(std::nan(""));  // not a number: there is none
  v("before", before);
  step.before = std::isnan(before) ? std::nullopt : std::optional(before);
}

BondEnergy::Half BondEnergy::half(const ResolvedSystem& system, Ensemble& ensemble, const VariableName& input) const {
  const auto variable = system.find(input, description_->place);
  const auto connection = std::ranges::find(system.connections, variable, &ResolvedConnection::to);
  if (connection != system.connections.end() && connection->inner) {
    throw InputError(
        ErrorCode::invalid_value,
        fmt::format("{}: the connection to '{}' lies within a continuous system, whose solver evaluates it "
                    "at every step: the coupling makes no energy. Remove the bond",
                    description_->place, input.text()));
  }
  if (connection == system.connections.end() || !is_measured(*connection)) {
    throw InputError(ErrorCode::invalid_value,
                     fmt::format("{}: '{}' is not a continuous Real input with a connection; a bond's effort and flow "
                                 "are the two inputs that take them",
                                 description_->place, input.text()));
  }
  return {.output = ensemble.watch(connection->from),
          .factor = connection->factor,
          .offset = connection->offset,
          .course = ensemble.course_of(connection->to),
          .step = {}};
}

BondEnergy::BondEnergy(const ResolvedSystem& system, Ensemble& ensemble, const BondDescription& description)
    : description_(&description), ensemble_(&ensemble) {
  const auto effort = system.find(description.effort, description.place);
  const auto flow = system.find(description.flow, description.place);
  halves_ = {half(system, ensemble, description.effort), half(system, ensemble, description.flow)};
  const auto source_of = [&](const ResolvedVariable& input) {
    return std::ranges::find(system.connections, input, &ResolvedConnection::to)->from.instance;
  };
  if (source_of(effort) != flow.instance || source_of(flow) != effort.instance) {
    throw InputError(ErrorCode::invalid_value,
                     fmt::format("{}: '{}' and '{}' are not a bond: the effort goes to '{}' and must come from the "
                                 "instance that takes the flow, and the other way round",
                                 description.place, description.effort.text(), description.flow.text(),
                                 description.effort.instance));
  }
  const auto& effort_taker = *system.instances[effort.instance].description;
  const auto& flow_taker = *system.instances[flow.instance].description;
  steps_ = effort_taker.steps;
  if (steps_ != flow_taker.steps) {
    throw InputError(ErrorCode::invalid_value,
                     fmt::format("{}: the two instances of a bond need the same step; '{}' has {} s and '{}' {} s",
                                 description.place, description.effort.instance,
                                 time_text(system.description->step_of(effort_taker)), description.flow.instance,
                                 time_text(system.description->step_of(flow_taker))));
  }
  unit_ = product_text(effort.variable->unit, flow.variable->unit);
}

void BondEnergy::reached(const Point& point, const TimeGrid& grid) {
  if (point.step % steps_ != 0) return;
  if (start_ns_) {
    const double length_s = grid.length_s(*start_ns_, point.time_ns);
    for (auto& half : halves_) half.step.last = ensemble_->real(half.output);
    const auto& effort = halves_[0];
    const auto& flow = halves_[1];
    const auto efforts = effort.step.coefficients(length_s);
    const auto flows = flow.step.coefficients(length_s);
    // All in the units of the effort's input and of the flow's output. With p the input's course:
    //   taken = integral p_e f,  given = integral (c_e e + o_e) (p_f - o_f) / c_f
    auto efforts_as_input = efforts;
    for (auto& coefficient : efforts_as_input) coefficient *= effort.factor;
    efforts_as_input[0] += effort.offset;
    const double taken = product_integral(effort.course, 1, 0, flows, length_s);
    const double given =
        product_integral(flow.course, 1 / flow.factor, -flow.offset / flow.factor, efforts_as_input, length_s);
    made_ += taken - given;
    passed_ += std::abs(product_integral(efforts_as_input, flows, length_s));
    largest_ = std::max(largest_, std::abs(made_));
  }
  for (auto& half : halves_) {
    half.step.before = start_ns_ ? std::optional(half.step.first) : std::nullopt;
    half.step.first = ensemble_->real(half.output);
  }
  start_ns_ = point.time_ns;
}

int BondEnergy::order() const {
  return 1 + static_cast<int>(std::min(halves_[0].course.derivatives.size(), halves_[1].course.derivatives.size()));
}

void BondEnergy::visit(state::Visitor& v) {
  v("start_ns", start_ns_);
  v("made", made_);
  v("passed", passed_);
  v("largest", largest_);
  v("halves", std::span(halves_));
}

Json BondEnergy::json() const {
  Json json = {{"made", made_}, {"most_made", largest_}, {"passed", passed_}, {"relative", relative()}};
  json["limit"] = description_->limit;
  if (!unit_.empty()) json["unit"] = unit_;
  return json;
}

Coupling::Coupling(const ResolvedSystem& system, Ensemble& ensemble)
    : grid_(system.description->grid()), step_s_(to_seconds(system.description->step)) {
  MEBOTS_ASSERT(system.description->coupling.has_value());
  const auto& description = *system.description->coupling;
  input_limit_ = description.input_limit;
  for (const auto& connection : system.connections) {
    if (is_measured(connection)) inputs_.emplace_back(system, ensemble, connection);
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

std::vector<std::string> Coupling::warnings() const {
  std::vector<std::string> warnings;
  for (const auto& bond : bonds_) {
    const auto& name = bond.description().name;
    const double limit = bond.description().limit;
    if (bond.relative() <= limit) continue;
    warnings.push_back(fmt::format(
        "the coupling {} energy in the bond '{}': {:.2g} of the energy that passed, more than its limit {:g}; {}",
        bond.made() > 0 ? "made" : "lost", name, bond.relative(), limit,
        advice(bond.relative(), limit, bond.order(), step_s_)));
  }
  for (const auto& input : inputs_) {
    if (!input_limit_ || input.relative() <= *input_limit_) continue;
    warnings.push_back(
        fmt::format("the input {} was {:.2g} of its range from what it would have been (root mean square), more than "
                    "the limit {:g}; {}",
                    input.input(), input.relative(), *input_limit_,
                    advice(input.relative(), *input_limit_, input.order(), step_s_)));
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
