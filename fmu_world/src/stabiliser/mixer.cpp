// SPDX-License-Identifier: Apache-2.0
#include "stabiliser/stabiliser.hpp"

#include "mebots/assert.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::world {
namespace {

struct Range {
  double low;
  double high;
};

Range range_of(const RotorValues& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return {*low, *high};
}

/// Returns the largest share in 0..1 for which every base + share * extra is in 0..max.
double largest_share(const RotorValues& base, const RotorValues& extra, double max) {
  double share = 1.0;
  for (std::size_t i = 0; i < kRotors; ++i) {
    if (extra[i] > 0.0) share = std::min(share, (max - base[i]) / extra[i]);
    if (extra[i] < 0.0) share = std::min(share, -base[i] / extra[i]);
  }
  return std::max(share, 0.0);
}

}  // namespace

RotorValues mix(const scene::Drone& drone, double max_thrust_n, double collective_n,
                const Eigen::Vector3d& torque_B_n_m) {
  MEBOTS_ASSERT(max_thrust_n > 0 && drone.arm_m > 0 && drone.torque_per_thrust_m > 0);
  RotorValues tilt{};
  RotorValues yaw{};
  for (std::size_t i = 0; i < kRotors; ++i) {
    tilt[i] = 0.25 * (kRotorY[i] * torque_B_n_m.x() - kRotorX[i] * torque_B_n_m.y()) / drone.arm_m;
    yaw[i] = 0.25 * kRotorYawSign[i] * torque_B_n_m.z() / drone.torque_per_thrust_m;
  }
  const Range wanted = range_of(tilt);
  const double spread_n = wanted.high - wanted.low;
  if (spread_n > max_thrust_n) {
    for (double& t : tilt) t *= max_thrust_n / spread_n;
  }
  const Range possible = range_of(tilt);
  const double each_n =
      std::clamp(0.25 * collective_n, -possible.low, std::max(-possible.low, max_thrust_n - possible.high));
  RotorValues thrust{};
  for (std::size_t i = 0; i < kRotors; ++i) thrust[i] = each_n + tilt[i];
  const double share = largest_share(thrust, yaw, max_thrust_n);
  MEBOTS_ASSERT(share >= 0 && share <= 1);
  // The clamp only removes the rounding error, which is about 1e-17 N.
  for (std::size_t i = 0; i < kRotors; ++i) thrust[i] = std::clamp(thrust[i] + share * yaw[i], 0.0, max_thrust_n);
  return thrust;
}

}  // namespace mebots::world
