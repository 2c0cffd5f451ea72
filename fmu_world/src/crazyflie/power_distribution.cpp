// SPDX-License-Identifier: Apache-2.0
#include "crazyflie/power_distribution.hpp"

#include <algorithm>

namespace mebots::world::crazyflie {
namespace {

constexpr double kFull = 65535.0;
// Constants of crazyflie-firmware, platform_defaults_cf2.h: VMOTOR2THRUST0 to 3, THRUST_MIN, THRUST_MAX.
constexpr ThrustOverVoltage kLegacy{
    .constant_n = -0.014830744918356092,
    .linear_n_per_v = 0.04724465241828281,
    .square_n_per_v2 = -0.01847364358025878,
    .cubic_n_per_v3 = 0.005960923942142,
    .least_n = 0.012817578393224994,
    .most_n = 0.12,
};
constexpr ThrustOverVoltage kPlus{
    .constant_n = -0.02476537915958403,
    .linear_n_per_v = 0.06523793527519485,
    .square_n_per_v2 = -0.026792504967750107,
    .cubic_n_per_v3 = 0.006776789303971145,
    .least_n = 0.012817578393224994,
    .most_n = 0.12,
};
constexpr ThrustOverVoltage kThrustUpgrade{
    .constant_n = 0.006728127583707208,
    .linear_n_per_v = 0.01011557616217668,
    .square_n_per_v2 = 0.010263198062061085,
    .cubic_n_per_v3 = 0.0028358638322392503,
    .least_n = 0.01922636758983749,
    .most_n = 0.18,
};

/// Returns the motor voltage that gives a thrust. Uses Newton's method from 4 V. The thrust rises with the voltage, and
/// is a convex function above 1.32 V, so the iterates fall to a root above 1.32 V. A root below 1.32 V takes more
/// steps.
double motor_voltage_v(double thrust_n, const ThrustOverVoltage& rotor) {
  double v = 4.0;
  constexpr int kSteps = 16;
  for (int i = 0; i < kSteps; ++i) {
    const double thrust_at_v =
        rotor.constant_n + v * (rotor.linear_n_per_v + v * (rotor.square_n_per_v2 + v * rotor.cubic_n_per_v3));
    const double slope = rotor.linear_n_per_v + v * (2.0 * rotor.square_n_per_v2 + v * 3.0 * rotor.cubic_n_per_v3);
    v -= (thrust_at_v - thrust_n) / slope;
  }
  return v;
}

}  // namespace

RotorValues distributed(const Demand& demand) {
  RotorValues shares{};
  for (std::size_t i = 0; i < kRotors; ++i) {
    shares[i] = (demand.thrust + 0.5 * kRotorY[i] * demand.roll - 0.5 * kRotorX[i] * demand.pitch +
                 kRotorYawSign[i] * demand.yaw) /
                kFull;
  }
  return shares;
}

const ThrustOverVoltage& thrust_over_voltage(Propellers propellers) {
  switch (propellers) {
    case Propellers::plus:
      return kPlus;
    case Propellers::thrust_upgrade:
      return kThrustUpgrade;
    case Propellers::legacy:
      break;
  }
  return kLegacy;
}

double compensated(double share, double supply_v, const ThrustOverVoltage& rotor) {
  const double thrust_n = rotor.most_n * share;
  return thrust_n < rotor.least_n ? 0.0 : motor_voltage_v(thrust_n, rotor) / supply_v;
}

RotorValues capped(const RotorValues& shares) {
  const double excess = std::max(0.0, *std::max_element(shares.begin(), shares.end()) - 1.0);
  RotorValues command{};
  for (std::size_t i = 0; i < kRotors; ++i) command[i] = std::clamp(shares[i] - excess, 0.0, 1.0);
  return command;
}

}  // namespace mebots::world::crazyflie
