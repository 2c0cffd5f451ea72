// SPDX-License-Identifier: Apache-2.0
#include "engine/coupling_error.hpp"

#include "base/time.hpp"
#include "mebots/assert.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace mebots::master {
namespace {

/// Returns 1 / number. Small numbers come from a table, because divisions take most of the time of an integral.
double reciprocal(std::size_t number) {
  constexpr std::array kKnown = {0.0, 1.0, 1.0 / 2, 1.0 / 3, 1.0 / 4, 1.0 / 5, 1.0 / 6, 1.0 / 7, 1.0 / 8};
  return number < kKnown.size() ? kKnown[number] : 1 / static_cast<double>(number);
}

/// Evaluates an input's polynomial value + d_1 tau + d_2 tau^2 / 2! + ... by Horner's method.
double at(const InputCourse& course, double tau_s) {
  double sum = 0;
  for (auto order = course.derivatives.size(); order > 0; --order) {
    sum = (sum + course.derivatives[order - 1]) * tau_s * reciprocal(order);
  }
  return *course.value + sum;
}

/// Returns the integral of (scale * input + offset) * output over a step. Sums the terms a_i d_j / j! tau^(i + j + 1) /
/// (i + j + 1), where a_i are the coefficients of the output and d_j the derivatives of the scaled input.
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

/// Returns the integral of the product of two parabolas over a step.
double product_integral(const std::array<double, 3>& one, const std::array<double, 3>& other, double length_s) {
  // Sums c_n tau^(n + 1) / (n + 1) from the highest power. c_n is the sum of a_i b_j over i + j = n.
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

std::string product_text(const std::string& one, const std::string& other) {
  return one.empty() || other.empty() ? "" : fmt::format("{}.{}.s", one, other);
}

/// Returns the connection to one of the two inputs that a bond names.
const ResolvedConnection& half(const ResolvedSystem& system, const VariableName& input, const std::string& place) {
  const auto variable = system.find(input, place);
  const auto connection = std::ranges::find(system.connections, variable, &ResolvedConnection::to);
  if (connection != system.connections.end() && connection->inner) {
    throw InputError(
        ErrorCode::invalid_value,
        fmt::format("{}: the connection to '{}' lies within a continuous system, whose solver evaluates it "
                    "at every step: the coupling creates no energy. Remove the bond",
                    place, input.text()));
  }
  if (connection == system.connections.end() || !connection->moves_real()) {
    throw InputError(ErrorCode::invalid_value,
                     fmt::format("{}: '{}' is not a Real input with one connection; effort and flow of a bond are "
                                 "two such inputs",
                                 place, input.text()));
  }
  return *connection;
}

}  // namespace

std::array<double, 3> OutputCourse::coefficients(double length_s) const {
  const double rise = last - first;
  if (!before) return {first, rise / length_s, 0};
  // Uses ratios of lengths, so that equal lengths give a factor of exactly 1.
  const double both_s = length_s + before_length_s;
  const double longer = length_s / before_length_s;
  const double earlier_rise = first - *before;
  return {first, (rise / longer + earlier_rise * longer) / both_s,
          (rise / longer - earlier_rise) / (before_length_s * both_s)};
}

CoupledInput::CoupledInput(Ensemble& ensemble, const ResolvedConnection& connection)
    : ensemble_(&ensemble),
      output_(ensemble.watch(connection.from)),
      factor_(connection.factor),
      offset_(connection.offset),
      input_(ensemble.course_of(connection.to)) {}

double CoupledInput::input_at(std::int64_t time_ns, const TimeGrid& grid) const {
  return at(input_, grid.length_s(*input_.start_ns, time_ns));
}

void CoupledInput::advance(std::int64_t time_ns, const TimeGrid& grid) {
  if (start_ns_) {
    before_ = first_;
    before_length_s_ = grid.length_s(*start_ns_, time_ns);
  }
  first_ = ensemble_->real(output_);
  start_ns_ = time_ns;
}

OutputCourse CoupledInput::course() const {
  return {.before = before_, .before_length_s = before_length_s_, .first = first_, .last = ensemble_->real(output_)};
}

double CoupledInput::deviation_integral(std::int64_t time_ns, const TimeGrid& grid) const {
  MEBOTS_ASSERT(start_ns_.has_value(), "advance() comes first");
  const double length_s = grid.length_s(*start_ns_, time_ns);
  const double at_end = std::abs(input_at(time_ns, grid) - value());
  if (*input_.start_ns != *start_ns_) return at_end * length_s;  // the two steps started at different times
  const double middle_s = length_s / 2;
  const auto [c0, c1, c2] = course().coefficients(length_s);
  const double in_middle = at(input_, middle_s) - (factor_ * (c0 + (c1 + c2 * middle_s) * middle_s) + offset_);
  const double at_start = *input_.value - (factor_ * first_ + offset_);
  return (std::abs(at_start) + 4 * std::abs(in_middle) + at_end) * length_s / 6;
}

void CoupledInput::visit(state::Visitor& v) {
  v("start_ns", start_ns_);
  v("first", first_);
  v("before", before_);
  v("before_length_s", before_length_s_);
}

PowerBond::PowerBond(const ResolvedSystem& system, Ensemble& ensemble, const BondDescription& description)
    : description_(&description),
      effort_(ensemble, half(system, description.effort, description.place)),
      flow_(ensemble, half(system, description.flow, description.place)) {
  const auto& effort = half(system, description.effort, description.place);
  const auto& flow = half(system, description.flow, description.place);
  if (effort.from.instance != flow.to.instance || flow.from.instance != effort.to.instance) {
    throw InputError(
        ErrorCode::invalid_value,
        fmt::format("{}: '{}' and '{}' are not a bond: the effort goes to '{}' and must come from the "
                    "instance that receives the flow; the flow must come from the instance that receives the effort",
                    description.place, description.effort.text(), description.flow.text(),
                    description.effort.instance));
  }
  const auto& effort_taker = *system.instances[effort.to.instance].description;
  const auto& flow_taker = *system.instances[flow.to.instance].description;
  steps_ = effort_taker.steps;
  if (steps_ != flow_taker.steps) {
    throw InputError(ErrorCode::invalid_value,
                     fmt::format("{}: the two instances of a bond need the same step; '{}' has {} s and '{}' {} s",
                                 description.place, description.effort.instance,
                                 time_text(system.description->step_of(effort_taker)), description.flow.instance,
                                 time_text(system.description->step_of(flow_taker))));
  }
  unit_ = product_text(effort.to.variable->unit, flow.to.variable->unit);
}

std::optional<PowerBond::Energy> PowerBond::energy(const Point& point, const TimeGrid& grid) const {
  if (point.step % steps_ != 0 || !effort_.start_ns()) return std::nullopt;
  const double length_s = grid.length_s(*effort_.start_ns(), point.time_ns);
  const auto efforts = effort_.course().coefficients(length_s);
  const auto flows = flow_.course().coefficients(length_s);
  // Both integrals use the unit of the effort at its input and the unit of the flow at its output. p_e and p_f are the
  // polynomials of the inputs, c and o the factors and offsets of the connections:
  //   taken = integral p_e f,  given = integral (c_e e + o_e) (p_f - o_f) / c_f
  auto efforts_as_input = efforts;
  for (auto& coefficient : efforts_as_input) coefficient *= effort_.factor();
  efforts_as_input[0] += effort_.offset();
  const double taken = product_integral(effort_.input(), 1, 0, flows, length_s);
  const double given =
      product_integral(flow_.input(), 1 / flow_.factor(), -flow_.offset() / flow_.factor(), efforts_as_input, length_s);
  return Energy{.made = taken - given,
                .passed = std::abs(product_integral(efforts_as_input, flows, length_s)),
                .length_s = length_s};
}

void PowerBond::advance(const Point& point, const TimeGrid& grid) {
  if (point.step % steps_ != 0) return;
  effort_.advance(point.time_ns, grid);
  flow_.advance(point.time_ns, grid);
}

void PowerBond::visit(state::Visitor& v) {
  v("effort", effort_);
  v("flow", flow_);
}

}  // namespace mebots::master
