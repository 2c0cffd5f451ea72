// SPDX-License-Identifier: Apache-2.0
#include "rotor_data.hpp"

#include "mebots/data_file.hpp"

#include <algorithm>

namespace mebots::motors {
namespace {

using data::Limits;

void read_steady_speed(const data::Node& root, RotorData& rotor) {
  const data::Node node = root.object("steady_speed");
  node.only({"source", "effective_voltage", "speed", "slope_above"});
  if (node.text("source").empty()) node.fail("source", "is empty: say where the values come from");
  const data::Node voltage = node.object("effective_voltage");
  voltage.only({"unit", "value"}).require_unit("V");
  rotor.effective_voltage_v = voltage.rising_numbers("value", Limits::at_least(0));
  const data::Node speed = node.object("speed");
  speed.only({"unit", "value"}).require_unit("rad/s");
  rotor.speed_rad_per_s = speed.rising_numbers("value", Limits::at_least(0));
  if (rotor.speed_rad_per_s.size() != rotor.effective_voltage_v.size()) {
    speed.fail("value", fmt::format("has {} entries but effective_voltage has {}", rotor.speed_rad_per_s.size(),
                                    rotor.effective_voltage_v.size()));
  }
  if (rotor.speed_rad_per_s.size() < 2) speed.fail("value", "needs at least two points");
  if (rotor.effective_voltage_v.front() != 0) voltage.fail("value[0]", "must be 0: standstill");
  if (rotor.speed_rad_per_s.front() != 0) speed.fail("value[0]", "must be 0: standstill");
  rotor.slope_above_rad_per_sv = node.quantity("slope_above", "rad/(s.V)", Limits::at_least(0));
}

SpeedLaw read_law(const data::Node& root, const std::string& name) {
  const SpeedLaw law{root.quantity(name + "_linear", "1/s", Limits::at_least(0)),
                     root.quantity(name + "_quadratic", "1/rad", Limits::at_least(0))};
  if (law.linear_per_s == 0 && law.quadratic_per_rad == 0) {
    root.fail(name + "_linear",
              fmt::format("and {}_quadratic are both 0: the rotor would never change its speed", name));
  }
  return law;
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

RotorData load_rotor(const std::filesystem::path& path) {
  const data::File file(path);
  const data::Node root = file.root();
  root.only({"name", "notes", "thrust_coefficient", "reference_density", "torque_per_thrust", "steady_speed",
             "spin_up_linear", "spin_up_quadratic", "spin_down_linear", "spin_down_quadratic", "inertia",
             "power_per_speed", "power_per_thrust", "propeller_pitch", "propulsion_efficiency", "lift_to_drag",
             "bench"});
  RotorData rotor;
  rotor.name = root.text("name");
  rotor.thrust_coefficient = root.quantity("thrust_coefficient", "N.s2/rad2", Limits::positive());
  rotor.reference_density_kg_per_m3 = root.quantity("reference_density", "kg/m3", Limits::positive());
  rotor.torque_per_thrust_m = root.quantity("torque_per_thrust", "m", Limits::positive());
  read_steady_speed(root, rotor);
  rotor.spin_up = read_law(root, "spin_up");
  rotor.spin_down = read_law(root, "spin_down");
  rotor.inertia_kg_m2 = root.quantity("inertia", "kg.m2", Limits::positive());
  rotor.power_per_speed_ws_per_rad = root.quantity("power_per_speed", "W.s/rad", Limits::at_least(0));
  rotor.power_per_thrust_w_per_n = root.quantity("power_per_thrust", "W/N", Limits::positive());
  rotor.propeller_pitch_m = root.quantity("propeller_pitch", "m", Limits::positive());
  rotor.propulsion_efficiency = root.quantity("propulsion_efficiency", "1", {0, 1, false});
  rotor.lift_to_drag = root.quantity("lift_to_drag", "1", Limits::positive());
  return rotor;
}

}  // namespace mebots::motors
