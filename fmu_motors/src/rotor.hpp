// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "rotor_data.hpp"

namespace mebots::motors {

struct RotorDrive {
  double steady_speed_rad_per_s = 0;
  double thrust_coefficient = 0;  // at the present air density [N s^2/rad^2]
  bool driven = false;            // false: the driver is off and takes no power
  double voltage_v = 0;           // duty cycle times bus voltage
  double duty = 0;
};

struct RotorStep {
  double speed_rad_per_s = 0;  // speed at the end of the step
  double energy_j = 0;         // electrical energy taken during the step, >= 0
  double charge_c = 0;         // charge through the winding of an electric motor, >= 0
};

/// Advances one rotor by `duration_s`, in closed form without a step size. The electrical power is
/// P = max(0, a w + b F + J w dw/dt)
/// with the speed w, power_per_speed a, power_per_thrust b, the thrust F and the inertia J. The first two terms are the
/// power on the bench at that speed, and the third is the power into the rotor's inertia. A decelerating rotor covers
/// part of its losses with its kinetic energy, but never supplies the bus.
RotorStep advance_rotor(const RotorData& rotor, const RotorDrive& drive, double speed_rad_per_s, double duration_s);

}  // namespace mebots::motors
