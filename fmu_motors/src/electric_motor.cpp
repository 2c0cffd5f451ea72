// SPDX-License-Identifier: Apache-2.0
#include "electric_motor.hpp"

#include "mebots/assert.hpp"
#include "speed_course.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::motors {
namespace {

/// Returns the ratio of drag torque to speed squared [N m s^2/rad^2].
double drag_coefficient(const RotorData& rotor, double thrust_coefficient) {
  return rotor.torque_per_thrust_m * thrust_coefficient;
}

double ripple_power_w(const ElectricMotor& motor, const RotorDrive& drive) {
  const double off_share = 1 - drive.duty;
  return motor.ripple_conductance_s * drive.voltage_v * drive.voltage_v * off_share * off_share;
}

}  // namespace

double steady_speed_rad_per_s(const RotorData& rotor, double thrust_coefficient, double voltage_v) {
  MEBOTS_ASSERT(rotor.motor && voltage_v >= 0);
  const double emf = rotor.motor->back_emf_vs_per_rad;
  // This form of the root of v = K u + R c u^2 / K has no difference of nearly equal numbers.
  const double square = rotor.motor->resistance_ohm * drag_coefficient(rotor, thrust_coefficient) / emf;
  return 2 * voltage_v / (emf + std::sqrt(emf * emf + 4 * square * voltage_v));
}

SupplyLoad supply_load(const ElectricMotor& motor, double duty, double speed_rad_per_s, double supply_v) {
  const double emf_v = motor.back_emf_vs_per_rad * speed_rad_per_s;
  if (duty * supply_v <= emf_v) return {};
  return {duty * duty / motor.resistance_ohm, duty * emf_v / motor.resistance_ohm};
}

RotorStep advance_motor(const RotorData& rotor, const RotorDrive& drive, double speed_rad_per_s, double duration_s) {
  MEBOTS_ASSERT(rotor.motor && speed_rad_per_s >= 0 && duration_s > 0);
  const ElectricMotor& motor = *rotor.motor;
  const double quadratic = drag_coefficient(rotor, drive.thrust_coefficient) / rotor.inertia_kg_m2;
  const double no_current_above = drive.voltage_v / motor.back_emf_vs_per_rad;

  double left_s = duration_s;
  double speed = speed_rad_per_s;
  if (speed > no_current_above) {
    const SpeedCourse coasting({0, quadratic}, speed, 0);
    const double end = std::max(coasting.speed(duration_s), 0.0);
    const double energy_j = drive.driven ? ripple_power_w(motor, drive) * duration_s : 0;
    if (!drive.driven || end >= no_current_above) return {end, energy_j, 0};
    left_s = std::max(duration_s - coasting.time_to(no_current_above), 0.0);
    speed = no_current_above;
  }
  const double emf = motor.back_emf_vs_per_rad;
  const SpeedLaw law{emf * emf / (motor.resistance_ohm * rotor.inertia_kg_m2), quadratic};
  const SpeedCourse course(law, speed, drive.steady_speed_rad_per_s);
  // Rounding may make the charge slightly negative.
  const double charge_c =
      std::max((drive.voltage_v * left_s - emf * course.speed_integral(left_s)) / motor.resistance_ohm, 0.0);
  const double end = std::max(course.speed(left_s), 0.0);
  if (!drive.driven) return {end, 0, 0};
  return {end, drive.voltage_v * charge_c + ripple_power_w(motor, drive) * duration_s, charge_c};
}

}  // namespace mebots::motors
