// SPDX-License-Identifier: Apache-2.0
#include "model.hpp"

#include "electric_motor.hpp"
#include "hover_propel.hpp"
#include "inflow.hpp"
#include "mebots/assert.hpp"
#include "mebots/data/find_file.hpp"
#include "mebots/data/limits.hpp"

#include <fmt/format.h>
#include <algorithm>

namespace mebots::motors {
namespace {

/// Maximum magnitude of an input, so that products of a few inputs are finite. fmu_world has the same limit.
constexpr double kMost = 1e40;
constexpr double kLeastDensity = 1 / kMost;
/// If the current of the step before the last step is less than this share of the last step's current, the last step's
/// current is a surge.
constexpr double kEarlierShare = 0.1;
/// Minimum sag of the voltage for a warning. Other loads may have caused a smaller sag.
constexpr double kLeastSag_v = 0.02;

void check(double value, std::string_view name, std::string_view unit, const data::Limits& limits) {
  if (limits.admit(value)) return;
  throw Error(fmt::format("{} = {}{}{} must be {}", name, value, unit.empty() ? "" : " ", unit, limits.text()));
}

void check(const Inputs& inputs) {
  using data::Limits;
  for (std::size_t i = 0; i < rotor::kCount; ++i) {
    const double command = inputs.rotor_command[i];
    if (Limits::between(0, 1).admit(command)) continue;
    throw Error(fmt::format("{}.command = {} must be >= 0 and <= 1: a duty cycle", rotor::kWords[i], command));
  }
  check(inputs.bus_voltage_v, "bus.voltage", "V", Limits::between(0, kMost));
  check(inputs.air_density_kg_per_m3, "air.density", "kg/m3", Limits::between(kLeastDensity, kMost));
  check(inputs.body_mass_kg, "body.mass", "kg", Limits::between(0, kMost));
  check(inputs.body_speed_m_per_s, "body.speed", "m/s", Limits::between(0, kMost));
  check(inputs.body_climb_m_per_s, "body.climb", "m/s", Limits::between(-kMost, kMost));
}

double effective_voltage_v(const Inputs& inputs, std::size_t i) {
  return inputs.rotor_command[i] * inputs.bus_voltage_v;
}

PowerModel checked(PowerModel model) {
  if (model == PowerModel::bench || model == PowerModel::hover_propel) return model;
  throw Error(fmt::format("power_model = {} must be 1 (bench) or 2 (hover_propel)", static_cast<int>(model)));
}

}  // namespace

Model::Model(const Parameters& parameters, const std::filesystem::path& resources, const Log& log)
    : log_(log),
      rotor_(load_rotor(data::find_file(resources / "rotors", parameters.rotor_data, "rotor_data"),
                        {parameters.calibration_thrust, parameters.calibration_power})),
      power_model_(checked(parameters.power_model)),
      avionics_base_power_w_(parameters.avionics_base_power_w),
      inflow_(parameters.inflow),
      inflow_radius_m_(parameters.inflow_radius_m),
      bus_resistance_ohm_(parameters.bus_resistance_ohm) {
  for (const auto& warning : rotor_.warnings) {
    if (log_) log_(warning);
  }
  check(bus_resistance_ohm_, "bus.resistance", "Ohm", data::Limits::between(0, kMost));
  check(inflow_radius_m_, "inflow.radius", "m", data::Limits::at_least(0.001));
  check(avionics_base_power_w_, "avionics.base_power", "W", data::Limits::at_least(0));
}

void Model::start(const Inputs& inputs, Outputs& outputs) {
  check(inputs);
  write(inputs, outputs);
}

void Model::step(const Inputs& inputs, std::int64_t duration_ns, Outputs& outputs) {
  check(inputs);
  const double duration_s = static_cast<double>(duration_ns) * 1e-9;
  MEBOTS_ASSERT(duration_ns > 0);
  double bench_j = 0;
  double motor_c = 0;
  bool driven = false;
  warn_of_double_sag(inputs.bus_voltage_v);
  const double supply_v = supply_voltage_v(inputs);
  for (std::size_t i = 0; i < rotor::kCount; ++i) {
    const RotorDrive drive = drive_of(inputs, supply_v, i);
    const RotorStep step = rotor_.motor ? advance_motor(rotor_, drive, speed_rad_per_s_[i], duration_s)
                                        : advance_rotor(rotor_, drive, speed_rad_per_s_[i], duration_s);
    MEBOTS_ASSERT(step.energy_j >= 0 && step.speed_rad_per_s >= 0);
    speed_rad_per_s_[i] = step.speed_rad_per_s;
    bench_j += step.energy_j;
    motor_c += drive.duty * step.charge_c;
    driven = driven || drive.driven;
  }
  earlier_current_a_ = last_current_a_;
  last_current_a_ = motor_c / duration_s;
  outputs.bench_power_w = rotor_.power_factor * bench_j / duration_s;
  outputs.hover_power_w = driven ? hover_power_w(rotor_, inputs.body_mass_kg, inputs.air_density_kg_per_m3) : 0;
  outputs.propel_power_w = driven ? propel_power_w(rotor_, inputs.body_mass_kg, inputs.body_speed_m_per_s) : 0;
  // The rotors never supply the bus: the inflow power must not make their power negative.
  outputs.inflow_power_w = driven && inflow_ ? std::max(inflow_power_w(inputs), -outputs.bench_power_w) : 0;
  outputs.power_w = power_model_ == PowerModel::bench ? outputs.bench_power_w + outputs.inflow_power_w
                                                      : outputs.hover_power_w + outputs.propel_power_w;
  energy_j_ += outputs.power_w * duration_s;
  write(inputs, outputs);
}

/// Returns the bus voltage at the present current: bus.voltage minus bus.resistance times the increase of the current.
/// Motors and battery step at the same time, so that bus.voltage belongs to the current of the step before the last
/// step.
double Model::supply_voltage_v(const Inputs& inputs) const {
  const double bus_v = inputs.bus_voltage_v;
  if (!rotor_.motor || bus_resistance_ohm_ == 0 || bus_v == 0) return bus_v;
  SupplyLoad all;
  for (std::size_t i = 0; i < rotor::kCount; ++i) {
    const SupplyLoad one = supply_load(*rotor_.motor, inputs.rotor_command[i], speed_rad_per_s_[i], bus_v);
    all.conductance_s += one.conductance_s;
    all.counter_current_a += one.counter_current_a;
  }
  return (bus_v + bus_resistance_ohm_ * (earlier_current_a_ + all.counter_current_a)) /
         (1 + bus_resistance_ohm_ * all.conductance_s);
}

/// Warns once if bus.voltage already contains the voltage drop due to the last step's increase of the current. This
/// happens if battery and motors do not step at the same time. It is assumed if bus.voltage has fallen by at least half
/// of that voltage drop.
void Model::warn_of_double_sag(double bus_v) {
  const double surge_a = last_current_a_ - earlier_current_a_;
  const bool is_surge = earlier_current_a_ < kEarlierShare * last_current_a_;
  const double sag_v = bus_resistance_ohm_ * surge_a;
  const double fall_v = last_bus_v_ - bus_v;
  last_bus_v_ = bus_v;
  if (warned_of_double_sag_ || !is_surge || sag_v < kLeastSag_v || fall_v < sag_v / 2) return;
  warned_of_double_sag_ = true;
  if (!log_) return;
  log_(fmt::format(
      "bus.voltage fell by {:.3g} V together with the last step's current of {:.3g} A, so that "
      "the voltage drop of bus.resistance = {} Ohm counts twice. Set bus.resistance to 0, or step motors and "
      "battery at the same time (algorithm jacobi)",
      fall_v, last_current_a_, bus_resistance_ohm_));
}

RotorDrive Model::drive_of(const Inputs& inputs, double supply_v, std::size_t i) const {
  RotorDrive drive;
  drive.duty = inputs.rotor_command[i];
  drive.voltage_v = drive.duty * supply_v;
  drive.driven = drive.voltage_v > 0;
  drive.thrust_coefficient = rotor_.thrust_coefficient_at(inputs.air_density_kg_per_m3);
  drive.steady_speed_rad_per_s = rotor_.motor
                                     ? steady_speed_rad_per_s(rotor_, drive.thrust_coefficient, drive.voltage_v)
                                     : rotor_.steady_speed_rad_per_s(drive.voltage_v);
  return drive;
}

/// Returns the electrical power due to the air flow through the driven rotors, minus that of hovering with the same
/// thrust. The thrust is that at the end of the step. The power of the air is divided by the efficiency of propeller
/// and motor.
double Model::inflow_power_w(const Inputs& inputs) const {
  const double coefficient = rotor_.thrust_coefficient_at(inputs.air_density_kg_per_m3);
  double power_w = 0;
  for (std::size_t i = 0; i < rotor::kCount; ++i) {
    if (!(effective_voltage_v(inputs, i) > 0)) continue;
    const double speed = speed_rad_per_s_[i];
    power_w += Inflow{coefficient * speed * speed, inputs.air_density_kg_per_m3, inflow_radius_m_,
                      inputs.body_speed_m_per_s, inputs.body_climb_m_per_s}
                   .power_beyond_hover_w();
  }
  return power_w / rotor_.propulsion_efficiency;
}

void Model::write(const Inputs& inputs, Outputs& outputs) const {
  const double coefficient = rotor_.thrust_coefficient_at(inputs.air_density_kg_per_m3);
  for (std::size_t i = 0; i < rotor::kCount; ++i) {
    outputs.rotor_speed_rad_per_s[i] = speed_rad_per_s_[i];
    outputs.rotor_thrust_n[i] = coefficient * speed_rad_per_s_[i] * speed_rad_per_s_[i];
    outputs.rotor_torque_n_m[i] = rotor_.torque_per_thrust_m * outputs.rotor_thrust_n[i];
  }
  outputs.power_model_used = power_model_;
  outputs.avionics_power_w = inputs.bus_voltage_v > 0 ? avionics_base_power_w_ : 0;
  outputs.energy_j = energy_j_;
}

void Model::visit(state::Visitor& v) {
  v("speed_rad_per_s", speed_rad_per_s_);
  v("energy_j", energy_j_);
  v("last_current_a", last_current_a_);
  v("earlier_current_a", earlier_current_a_);
  v("last_bus_v", last_bus_v_);
  v("warned_of_double_sag", warned_of_double_sag_);
}

}  // namespace mebots::motors
