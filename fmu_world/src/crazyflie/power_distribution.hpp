// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"
#include "fmu_world/variables.hpp"

namespace mebots::world::crazyflie {

/// The controllers' demand on all four motors together, in 1/65535 of a motor's full command.
struct Demand {
  double thrust = 0.0;
  double roll = 0.0;   ///< each side's motors receive half of it
  double pitch = 0.0;  ///< each side's motors receive half of it; positive = nose down
  double yaw = 0.0;    ///< positive = turn to the left
};

/// Returns each motor's share of its full thrust. The shares may be outside 0..1.
RotorValues distributed(const Demand& demand);

/// A rotor's thrust as a cubic function of its motor's voltage. The firmware publishes this fit.
struct ThrustOverVoltage {
  double constant_n;
  double linear_n_per_v;
  double square_n_per_v2;
  double cubic_n_per_v3;
  double least_n;  ///< below this thrust the motor does not turn
  double most_n;   ///< thrust at a share of 1
};

const ThrustOverVoltage& thrust_over_voltage(Propellers propellers);

/// Returns the duty cycle that gives a share of the full thrust at a supply voltage. If the supply voltage is too low,
/// the duty cycle is above 1. If the thrust is below the least thrust, the duty cycle is 0.
double compensated(double share, double supply_v, const ThrustOverVoltage& rotor);

/// Limits each motor's share of its full thrust to 0..1. If the greatest share exceeds 1, first subtracts its excess
/// from all four shares.
RotorValues capped(const RotorValues& shares);

}  // namespace mebots::world::crazyflie
