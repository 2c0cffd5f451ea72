// SPDX-License-Identifier: Apache-2.0
#include "stabiliser/gains.hpp"

#include <algorithm>

namespace mebots::world {

Gains::Rotation Gains::rotation(double pole_per_s, double lag_s) {
  // (s + p)^3 = s^3 + 3 p s^2 + 3 p^2 s + p^3 against
  // s^3 + (1 + k_a) / T s^2 + k_r / T s + k_r k_angle / T.
  const double rate = 3.0 * lag_s * pole_per_s * pole_per_s;
  return {pole_per_s / 3.0, rate, std::max(0.0, 3.0 * lag_s * pole_per_s - 1.0)};
}

Gains Gains::for_lag(double rotor_lag_s) {
  Gains gains{};
  // Below 1 / (3 p) the rotor is fast enough to be left out of the placement.
  gains.tilt = rotation(gains.tilt_pole_per_s, std::max(rotor_lag_s, 1.0 / (3.0 * gains.tilt_pole_per_s)));
  gains.yaw = rotation(gains.yaw_pole_per_s, std::max(rotor_lag_s, 1.0 / (3.0 * gains.yaw_pole_per_s)));
  return gains;
}

}  // namespace mebots::world
