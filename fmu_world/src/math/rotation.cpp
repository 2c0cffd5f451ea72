// SPDX-License-Identifier: Apache-2.0
#include "math/rotation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mebots::world {

Attitude attitude_of(const Eigen::Matrix3d& R_WB) {
  // R is Rz(yaw) Ry(pitch) Rx(roll), with the third row (-sin p, cos p sin r, cos p cos r).
  const double sin_pitch = std::clamp(0.0 - R_WB(2, 0), -1.0, 1.0);  // limits 1 + 1e-16 from rounding; 0 - x avoids -0
  Attitude attitude;
  attitude.pitch_rad = std::asin(sin_pitch);
  attitude.roll_rad = std::atan2(R_WB(2, 1), R_WB(2, 2));
  attitude.yaw_rad = wrapped_rad(std::atan2(R_WB(1, 0), R_WB(0, 0)));
  return attitude;
}

double wrapped_rad(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2.0 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? std::numbers::pi : wrapped;
}

Eigen::Quaterniond yaw_rotation(double yaw_rad) {
  return {std::cos(0.5 * yaw_rad), 0.0, 0.0, std::sin(0.5 * yaw_rad)};
}

Eigen::Quaterniond rotation_of(const Attitude& attitude) {
  Eigen::Quaterniond yaw = yaw_rotation(attitude.yaw_rad);
  if (attitude.pitch_rad == 0.0 && attitude.roll_rad == 0.0) return yaw;
  const Eigen::Quaterniond pitch{std::cos(0.5 * attitude.pitch_rad), 0.0, std::sin(0.5 * attitude.pitch_rad), 0.0};
  const Eigen::Quaterniond roll{std::cos(0.5 * attitude.roll_rad), std::sin(0.5 * attitude.roll_rad), 0.0, 0.0};
  return yaw * pitch * roll;
}

}  // namespace mebots::world
