// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "rotor.hpp"

namespace mebots::motors {

/// Returns the steady speed u [rad/s] of a motor with a propeller, at which K i = c u^2 with v = K u + R i and c =
/// torque_per_thrust k.
double steady_speed_rad_per_s(const RotorData& rotor, double thrust_coefficient, double voltage_v);

/// Load of one motor on its supply. At a supply voltage V, the motor's current is conductance V - counter current,
/// averaged over the PWM's period. If the motor takes no current at `supply_v`, both values are 0.
struct SupplyLoad {
  double conductance_s = 0;
  double counter_current_a = 0;
};
SupplyLoad supply_load(const ElectricMotor& motor, double duty, double speed_rad_per_s, double supply_v);

/// Advances a rotor with `motor` by `duration_s`. The equations are solved in closed form, without a step size:
///
///   i        = max(0, (v - K w) / R)                  the driver's diode blocks braking currents
///   J dw/dt  = K i - c w^2
///   P        = v i + g v^2 (1 - d)^2                  v = d V; g: ripple_conductance
///
/// v i is the power at the shaft, K i w, plus the copper loss, R i^2. The second term of P is the loss due to the
/// current ripple, whose amplitude is proportional to V d (1 - d).
RotorStep advance_motor(const RotorData& rotor, const RotorDrive& drive, double speed_rad_per_s, double duration_s);

}  // namespace mebots::motors
