// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"

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

/// Which share of the supply gives a share of 0.12 N, the firmware's greatest thrust of a rotor: by its published cubic
/// fit of thrust over motor voltage for legacy propellers. In 0 to 1, above 1 where the supply cannot give it, 0 below
/// 0.0128 N.
double compensated(double share, double supply_v);

/// A motor beyond full takes what it exceeds by off all four; none is below 0.
RotorValues capped(const RotorValues& shares);

}  // namespace mebots::world::crazyflie
