// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"
#include "fmu_world/variables.hpp"

namespace mebots::world::crazyflie {

/// What the cascade asks of the four motors together, in 1/65535 of a motor's full command.
struct Demand {
  double thrust = 0.0;
  double roll = 0.0;   ///< half of it to each side
  double pitch = 0.0;  ///< likewise, positive = nose down
  double yaw = 0.0;    ///< positive = to the left
};

/// Shares of a motor's full thrust, before limits.
RotorValues distributed(const Demand& demand);

/// The firmware's published fit of a rotor's thrust over its motor's voltage.
struct ThrustOverVoltage {
  double constant_n;
  double linear_n_per_v;
  double square_n_per_v2;
  double cubic_n_per_v3;
  double least_n;  ///< a motor stands still below
  double most_n;   ///< thrust of a full share
};

const ThrustOverVoltage& thrust_over_voltage(Propellers propellers);

/// Returns the duty cycle that gives a share of the greatest thrust: above 1 if the supply cannot give it, 0 below the
/// least thrust.
double compensated(double share, double supply_v, const ThrustOverVoltage& rotor);

/// A motor beyond full takes what it exceeds by off all four; none is below 0.
RotorValues capped(const RotorValues& shares);

}  // namespace mebots::world::crazyflie
