// SPDX-License-Identifier: Apache-2.0
#include "rotor_data.hpp"

#include "mebots/data/document.hpp"
#include "mebots/data/estimate.hpp"
#include "mebots/data/object.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace mebots::motors {
namespace {

using data::Limits;

/// Returns a function that reads an object {"unit", "value": [...]} and returns its list. The numbers must rise from 0.
auto table_from_rest(std::string_view unit) {
  return [unit](const data::Node& node) {
    data::Object object(node);
    std::vector<double> values;
    data::read_unit(object, unit);
    if (object.read("value", values, data::rising_numbers(Limits::at_least(0)))) {
      const auto list = node.at("value");
      if (values.size() < 2) list.complain(ErrorCode::invalid_value, "at least two points are needed");
      if (values.front() != 0) list.elements()[0].complain(ErrorCode::invalid_value, "this must be 0, for standstill");
    }
    object.finish();
    return values;
  };
}

void read_steady_speed(const data::Node& node, RotorData& rotor) {
  data::Object object(node);
  data::read_source(object);
  object.read("effective_voltage", rotor.effective_voltage_v, table_from_rest("V"));
  object.read("speed", rotor.speed_rad_per_s, table_from_rest("rad/s"));
  object.read("slope_above", rotor.slope_above_rad_per_sv, data::quantity("rad/(s.V)", Limits::at_least(0)));
  object.finish();
  if (object.sound() && rotor.speed_rad_per_s.size() != rotor.effective_voltage_v.size()) {
    node.at("speed").at("value").fail(ErrorCode::invalid_value,
                                      fmt::format("there are {} entries here, but {} in effective_voltage",
                                                  rotor.speed_rad_per_s.size(), rotor.effective_voltage_v.size()));
  }
}

void read_law(data::Object& object, const std::string& name, SpeedLaw& law) {
  const bool linear = object.read(name + "_linear", law.linear_per_s, data::quantity("1/s", Limits::at_least(0)));
  const bool quadratic =
      object.read(name + "_quadratic", law.quadratic_per_rad, data::quantity("1/rad", Limits::at_least(0)));
  if (linear && quadratic && law.linear_per_s == 0 && law.quadratic_per_rad == 0) {
    object.node()
        .at(name + "_linear")
        .complain(ErrorCode::invalid_value,
                  fmt::format("this and {}_quadratic are both 0: the rotor would never change its speed", name));
  }
}

void read_table_form(data::Object& object, RotorData& rotor) {
  using data::quantity;
  object.visit("steady_speed", [&](const data::Node& member) { return read_steady_speed(member, rotor); });
  read_law(object, "spin_up", rotor.spin_up);
  read_law(object, "spin_down", rotor.spin_down);
  object.read("power_per_speed", rotor.power_per_speed_ws_per_rad, quantity("W.s/rad", Limits::at_least(0)));
  object.read("power_per_thrust", rotor.power_per_thrust_w_per_n, quantity("W/N", Limits::positive()));
}

/// Reads the member `motor`, which determines speed and power. If a key of read_table_form() is also present, reports a
/// mistake, because `motor` already determines its quantity.
void read_motor_form(data::Object& object, RotorData& rotor) {
  object.visit("motor", [&](const data::Node& node) {
    data::Object member(node);
    ElectricMotor motor;
    member.read("resistance", motor.resistance_ohm, data::quantity("Ohm", Limits::positive()));
    member.read("back_emf", motor.back_emf_vs_per_rad, data::quantity("V.s/rad", Limits::positive()));
    member.read("ripple_conductance", motor.ripple_conductance_s, data::quantity("A/V", Limits::at_least(0)));
    member.finish();
    rotor.motor = motor;
  });
  for (const std::string key : {"steady_speed", "spin_up_linear", "spin_up_quadratic", "spin_down_linear",
                                "spin_down_quadratic", "power_per_speed", "power_per_thrust"}) {
    object.allow({key});
    if (!object.has(key)) continue;
    object.node().at(key).complain(ErrorCode::invalid_value,
                                   fmt::format("'motor' already determines this: remove '{}' or 'motor'", key));
  }
}

/// Sets the thrust coefficient without changing torque and power at a speed. The coefficients of torque and power are
/// per thrust, and change inversely.
void place_thrust(RotorData& rotor, double thrust_coefficient) {
  const double ratio = thrust_coefficient / rotor.thrust_coefficient;
  rotor.thrust_coefficient = thrust_coefficient;
  rotor.torque_per_thrust_m /= ratio;
  rotor.power_per_thrust_w_per_n /= ratio;
}

RotorData read_rotor(const data::Node& node, const RotorPositions& positions) {
  using data::quantity;
  const auto positive = Limits::positive();
  data::Object object(node);
  RotorData rotor;
  object.comment("$schema");
  object.read("name", rotor.name, &data::Node::text);
  object.comment("notes");
  data::Estimate thrust_coefficient;
  data::Estimate power_factor{1, {}};
  object.read("thrust_coefficient", thrust_coefficient, data::estimate("N.s2/rad2", positive));
  rotor.thrust_coefficient = thrust_coefficient.value;
  object.read_if("power_factor", power_factor, data::estimate("1", positive));
  object.read("reference_density", rotor.reference_density_kg_per_m3, quantity("kg/m3", positive));
  object.read("torque_per_thrust", rotor.torque_per_thrust_m, quantity("m", positive));
  object.read("inertia", rotor.inertia_kg_m2, quantity("kg.m2", positive));
  object.has("motor") ? read_motor_form(object, rotor) : read_table_form(object, rotor);
  object.read("propeller_pitch", rotor.propeller_pitch_m, quantity("m", positive));
  object.read("propulsion_efficiency", rotor.propulsion_efficiency, quantity("1", {0, 1, false}));
  object.read("lift_to_drag", rotor.lift_to_drag, quantity("1", positive));
  object.allow({"bench"});  // contains the source of the values, for readers and tests
  object.finish();
  const data::Placement placement("rotor '" + rotor.name + "'", rotor.warnings);
  rotor.power_factor = placement.value(power_factor, positions.power, "power_factor", "calibration.power");
  place_thrust(rotor,
               placement.value(thrust_coefficient, positions.thrust, "thrust_coefficient", "calibration.thrust"));
  return rotor;
}

}  // namespace

double RotorData::steady_speed_rad_per_s(double voltage_v) const {
  if (voltage_v >= effective_voltage_v.back()) {
    return speed_rad_per_s.back() + slope_above_rad_per_sv * (voltage_v - effective_voltage_v.back());
  }
  const auto above = std::upper_bound(effective_voltage_v.begin(), effective_voltage_v.end(), voltage_v);
  const auto i = static_cast<std::size_t>(above - effective_voltage_v.begin());
  if (i == 0) return 0;
  const double weight =
      (voltage_v - effective_voltage_v[i - 1]) / (effective_voltage_v[i] - effective_voltage_v[i - 1]);
  return speed_rad_per_s[i - 1] + weight * (speed_rad_per_s[i] - speed_rad_per_s[i - 1]);
}

RotorData load_rotor(const std::filesystem::path& path, const RotorPositions& positions) {
  return data::Document(path).read([&](const data::Node& node) { return read_rotor(node, positions); });
}

}  // namespace mebots::motors
