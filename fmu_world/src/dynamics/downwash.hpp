// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cmath>

namespace mebots::world {

/// Forces of other drones' air on a drone.
struct DownwashForce {
  double down_B_n = 0.0;  ///< along the body's -z axis
  double up_W_n = 0.0;    ///< along the world's z axis
};

/// Returns the force [N] that the air of an upper drone exerts on a lower drone, along the lower drone's -z axis. The
/// model and its numbers, which were measured on Crazyflies, are from gym-pybullet-drones (Panerati et al., IROS 2021):
///
///   F = 2267.18 (r / 4 dz)^2 exp(-(dxy / (0.16 dz - 0.11))^2 / 2),   dz > 0.6875, dxy < 10
///
/// `to_above_W_m` = (dx, dy, dz) points from the lower to the upper drone. r is the radius of the upper drone's rotors.
/// The formula contains neither thrust nor attitude. At dz = 0.6875 m, the width of the air column is 0. For smaller
/// dz, the force is 0, because the formula would give a growing width and a force above any thrust.
inline double downwash(const Eigen::Vector3d& to_above_W_m, double rotor_radius_m) {
  constexpr double kStrength_n = 2267.18;
  constexpr double kWidening = 0.16;
  constexpr double kNarrowing_m = 0.11;
  constexpr double kReach_m = 10.0;
  const double dz_m = to_above_W_m.z();
  const double dxy_m = to_above_W_m.head<2>().norm();
  const double width_m = kWidening * dz_m - kNarrowing_m;
  if (!(width_m > 0.0) || !(dxy_m < kReach_m)) return 0.0;
  const double ratio = rotor_radius_m / (4.0 * dz_m);
  const double aside = dxy_m / width_m;
  return kStrength_n * ratio * ratio * std::exp(-0.5 * aside * aside);
}

}  // namespace mebots::world
