// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace mebots::motors {

/// Coefficients of dw/dt = linear (u - w) + quadratic (u^2 - w^2), where u is the steady speed at the present voltage.
struct SpeedLaw {
  double linear_per_s = 0;
  double quadratic_per_rad = 0;
};

/// A brushed motor with a PWM driver whose diode blocks braking currents. Equations: electric_motor.hpp.
struct ElectricMotor {
  double resistance_ohm = 0;        // winding, brushes and driver together
  double back_emf_vs_per_rad = 0;   // also the torque per current [N m/A]
  double ripple_conductance_s = 0;  // loss due to the current ripple of the PWM [A/V]
};

/// Data of a rotor with its motor. fmu_motors/README.md documents the format of the data file.
struct RotorData {
  std::string name;
  double power_factor = 1;        // factor of the electrical power
  double thrust_coefficient = 0;  // F = k w^2 [N s^2/rad^2] at the reference density
  double reference_density_kg_per_m3 = 0;
  double torque_per_thrust_m = 0;
  double inertia_kg_m2 = 0;
  std::optional<ElectricMotor> motor;       // if present, the members up to power_per_thrust_w_per_n are unused
  std::vector<double> effective_voltage_v;  // table of steady speed over effective voltage; both lists begin at 0
  std::vector<double> speed_rad_per_s;
  double slope_above_rad_per_sv = 0;  // slope of the steady speed above the last point
  SpeedLaw spin_up;
  SpeedLaw spin_down;
  double power_per_speed_ws_per_rad = 0;  // P = a w + b F
  double power_per_thrust_w_per_n = 0;
  double propeller_pitch_m = 0;
  double propulsion_efficiency = 0;
  double lift_to_drag = 0;

  std::vector<std::string> warnings;  // quantities with a position, but without an interval in the file

  /// Returns the steady speed [rad/s] at a voltage [V, >= 0]. Only for rotors without `motor`.
  double steady_speed_rad_per_s(double voltage_v) const;

  /// Returns the ratio of thrust [N] to speed squared at an air density.
  double thrust_coefficient_at(double density_kg_per_m3) const {
    return thrust_coefficient * density_kg_per_m3 / reference_density_kg_per_m3;
  }
};

/// Position of each quantity in its interval in the rotor file: -1 and 1 are the ends of the interval, 0 is the nominal
/// value.
struct RotorPositions {
  double thrust = 0;  // for thrust_coefficient; torque and power at a speed do not change
  double power = 0;   // for power_factor
};

/// Reads and checks a rotor file. Throws mebots::Error that names file, key, value and limit. Also throws if a position
/// is outside -1 to 1.
RotorData load_rotor(const std::filesystem::path& path, const RotorPositions& positions = {});

}  // namespace mebots::motors
