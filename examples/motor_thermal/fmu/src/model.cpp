// SPDX-License-Identifier: Apache-2.0
#include "model.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>

#include <cmath>

namespace mebots::motor_thermal {
namespace {

/// The temperature coefficient of copper's resistance at 20 degrees Celsius [1/K]: IEC 60028, annealed copper.
constexpr double kCopper_per_k = 0.00393;
constexpr double kReference_k = 293.15;
/// The maximum temperature, far above the limits of insulation and magnet. If it is exceeded, the parameters are wrong.
constexpr double kRunaway_k = 1000;
constexpr double kMotors = 4;

/// Three functions of an eigenvalue l over the step t: exp(l t), and its first and second integrals.
struct Mode {
  double grown;
  double once;
  double twice;
};

Mode mode(double l, double t) {
  const double x = l * t;
  const double once = std::abs(x) < 1e-8 ? t * (1 + x / 2) : std::expm1(x) / l;
  // For small x, uses a series: `once` and `t` are then nearly equal, so their difference would lose digits.
  const double twice = std::abs(x) < 1e-3 ? t * t * (0.5 + x / 6 + x * x / 24 + x * x * x / 120) : (once - t) / l;
  return {std::exp(x), once, twice};
}

}  // namespace

Model::Model(const Parameters& parameters, const std::filesystem::path& /*resources*/)
    : parameters_(parameters), winding_k_(parameters.start_temperature_k), case_k_(parameters.start_temperature_k) {}

void Model::start(const Inputs& /*inputs*/, Outputs& outputs) {
  write(outputs);
}

void Model::step(const Inputs& inputs, std::int64_t duration_ns, Outputs& outputs) {
  const double t = 1e-9 * static_cast<double>(duration_ns);
  const auto& p = parameters_;
  // Computes the current of the winding: the battery's current divided by the duty cycle. The winding always carries
  // current, but the battery supplies it only during the duty cycle.
  const double effective_v = inputs.motor_command * inputs.bus_voltage_v;
  current_a_ = effective_v > 0 ? inputs.motor_power_w / kMotors / effective_v : 0;
  const double loss_w = current_a_ * current_a_ * p.winding_resistance_ohm;

  // The equations are x' = A x + g, with x = (T_w - T_air, T_c - T_air).
  const double a = (loss_w * kCopper_per_k - p.winding_conductance_w_per_k) / p.winding_heat_capacity_j_per_k;
  const double b = p.winding_conductance_w_per_k / p.winding_heat_capacity_j_per_k;
  const double c = p.winding_conductance_w_per_k / p.case_heat_capacity_j_per_k;
  const double d = -(p.winding_conductance_w_per_k + p.case_conductance_w_per_k) / p.case_heat_capacity_j_per_k;
  const double g =
      loss_w * (1 + kCopper_per_k * (inputs.air_temperature_k - kReference_k)) / p.winding_heat_capacity_j_per_k;
  const double x = winding_k_ - inputs.air_temperature_k;
  const double y = case_k_ - inputs.air_temperature_k;

  // The matrix has two eigenvalues l1 >= l2, which are real because b c >= 0. For a function f, f(A) = f(l1) P + f(l2)
  // (1 - P), with P = (A - l2) / (l1 - l2).
  const double middle = 0.5 * (a + d);
  const double half_gap = std::hypot(0.5 * (a - d), std::sqrt(b * c));
  const Mode m1 = mode(middle + half_gap, t);
  const Mode m2 = mode(middle - half_gap, t);
  const double gap = 2 * half_gap;
  const double p11 = gap > 0 ? (a - (middle - half_gap)) / gap : 1;
  const double p12 = gap > 0 ? b / gap : 0;
  const double p21 = gap > 0 ? c / gap : 0;
  const double p22 = gap > 0 ? (d - (middle - half_gap)) / gap : 0;
  const auto first = [&](double f1, double f2, double u, double v) { return f2 * u + (f1 - f2) * (p11 * u + p12 * v); };
  const auto second = [&](double f1, double f2, double u, double v) {
    return f2 * v + (f1 - f2) * (p21 * u + p22 * v);
  };

  const double mean_x = (first(m1.once, m2.once, x, y) + first(m1.twice, m2.twice, g, 0)) / t;
  const double mean_y = (second(m1.once, m2.once, x, y) + second(m1.twice, m2.twice, g, 0)) / t;
  winding_k_ = inputs.air_temperature_k + first(m1.grown, m2.grown, x, y) + first(m1.once, m2.once, g, 0);
  case_k_ = inputs.air_temperature_k + second(m1.grown, m2.grown, x, y) + second(m1.once, m2.once, g, 0);
  copper_j_ += t * loss_w * (1 + kCopper_per_k * (inputs.air_temperature_k + mean_x - kReference_k));
  air_j_ += t * p.case_conductance_w_per_k * mean_y;
  if (!(winding_k_ < kRunaway_k))
    throw Error(
        fmt::format("winding.temperature = {} K at a current of {} A: the winding burns; lower motor.power, or "
                    "raise winding.conductance",
                    winding_k_, current_a_));
  write(outputs);
}

void Model::write(Outputs& outputs) const {
  outputs.winding_temperature_k = winding_k_;
  outputs.case_temperature_k = case_k_;
  outputs.motor_current_a = current_a_;
  outputs.heat_copper_j = copper_j_;
  outputs.heat_air_j = air_j_;
}

void Model::visit(state::Visitor& v) {
  v("winding_k", winding_k_);
  v("case_k", case_k_);
  v("current_a", current_a_);
  v("copper_j", copper_j_);
  v("air_j", air_j_);
}

}  // namespace mebots::motor_thermal
