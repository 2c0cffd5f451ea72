// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

namespace mebots::world {

/// The angles [rad] of three rotations: yaw about z, then pitch about the new y, then roll about the new x. All are
/// right-handed: pitch is positive with the nose down, yaw is positive to the left.
struct Attitude {
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
  double yaw_rad = 0.0;  ///< in (-pi, pi]
};

Attitude attitude_of(const Eigen::Matrix3d& R_WB);

/// Adds a multiple of 2 pi to the angle, so that the result is in (-pi, pi].
double wrapped_rad(double angle_rad);

Eigen::Quaterniond yaw_rotation(double yaw_rad);
/// The result converts vectors from the rotated axes to the original axes.
Eigen::Quaterniond rotation_of(const Attitude& attitude);

}  // namespace mebots::world
