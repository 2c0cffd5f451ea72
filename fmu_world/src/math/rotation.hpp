// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

namespace mebots::world {

/// Contains the angles [rad] of three rotations: yaw about z, then pitch about the new y, then roll about the new x.
/// All are right-handed: pitch is positive with the nose down, and yaw is positive to the left.
struct Attitude {
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
  double yaw_rad = 0.0;  ///< in (-pi, pi]
};

Attitude attitude_of(const Eigen::Matrix3d& R_WB);

/// Returns the angle in (-pi, pi] that differs from `angle_rad` by a multiple of 2 pi.
double wrapped_rad(double angle_rad);

Eigen::Quaterniond yaw_rotation(double yaw_rad);
/// Returns the rotation that converts a vector from the turned axes to the original axes.
Eigen::Quaterniond rotation_of(const Attitude& attitude);

}  // namespace mebots::world
