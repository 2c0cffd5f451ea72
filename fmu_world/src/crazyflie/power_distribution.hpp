// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"
#include "fmu_world/variables.hpp"

namespace mebots::world::crazyflie {

/// Contains the controllers' demand on all four motors together, in 1/65535 of a motor's full command.
struct Demand {
  double thrust = 0.0;
  double roll = 0.0;   ///< each side's motors receive half of it
  double pitch = 0.0;  ///< each side's motors receive half of it; positive = nose down
  double yaw = 0.0;    ///< positive = turn to the left
};

/// Returns each motor's share of its full thrust. The shares are not yet limited to 0..1.
RotorValues distributed(const Demand& demand);

/// Contains the coefficients of a rotor's thrust over its motor's voltage, a cubic fit that the firmware publishes.
struct ThrustOverVoltage {
  double constant_n;
  double linear_n_per_v;
  double square_n_per_v2;
  double cubic_n_per_v3;
  double least_n;  ///< below this thrust the motor does not turn
  double most_n;   ///< thrust at a share of 1
};

const ThrustOverVoltage& thrust_over_voltage(Propellers propellers);

/// Returns the duty cycle that gives a share of the full thrust at a supply voltage. The duty cycle is above 1 if the
/// supply voltage is too low, and 0 for less than the least thrust.
double compensated(double share, double supply_v, const ThrustOverVoltage& rotor);

/// Limits the shares to 0..1: if a motor exceeds its full command, subtracts the excess from all four. No result is
/// below 0.
RotorValues capped(const RotorValues& shares);

}  // namespace mebots::world::crazyflie
