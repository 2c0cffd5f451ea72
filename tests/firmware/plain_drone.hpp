// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "rendered_world.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::firmware_test {

/// A drone with predictable motion: velocity and yaw rate follow their set-points as first-order lags, altitude changes
/// at a constant rate. The model of fmu_world is more detailed.
struct PlainDrone {
  static constexpr double kVelocityLag_s = 0.5;
  static constexpr double kYawRateLag_s = 0.1;
  static constexpr double kClimbRate_m_s = 0.5;

  BodyPose pose;
  double velocity_m_s = 0.0;
  double yaw_rate_rad_s = 0.0;

  void move(double step_s, double velocity_setpoint_m_s, double yaw_rate_setpoint_rad_s) {
    velocity_m_s += (velocity_setpoint_m_s - velocity_m_s) * step_s / kVelocityLag_s;
    yaw_rate_rad_s += (yaw_rate_setpoint_rad_s - yaw_rate_rad_s) * step_s / kYawRateLag_s;
    pose.yaw_rad += yaw_rate_rad_s * step_s;
    pose.p_WB_m += velocity_m_s * step_s * Eigen::Vector3d(std::cos(pose.yaw_rad), std::sin(pose.yaw_rad), 0);
  }
  /// Climbs or descends for one step. Returns true if the altitude was already reached before the step.
  bool climb(double step_s, double altitude_m) {
    const double way_m = altitude_m - pose.p_WB_m.z();
    pose.p_WB_m.z() += std::clamp(way_m, -kClimbRate_m_s * step_s, kClimbRate_m_s * step_s);
    return way_m == 0.0;
  }
};

/// Position and angle at which a drone crossed the plane of a gate that faces along the world's x axis.
struct Crossing {
  bool crossed = false;
  double lateral_m = 0.0;  ///< positive = left of the middle
  double angle_rad = 0.0;  ///< between heading and the gate's axis

  void look(const world::scene::Gate& gate, const Eigen::Vector3d& before_m, const BodyPose& after) {
    if (crossed || before_m.x() >= gate.p_W_m.x() || after.p_WB_m.x() < gate.p_W_m.x()) return;
    crossed = true;
    lateral_m = after.p_WB_m.y() - gate.p_W_m.y();
    angle_rad = std::remainder(after.yaw_rad - gate.yaw_rad, 2.0 * M_PI);
  }
  /// Returns true if a Crazyflie, which is 9.2 cm square, fits through the gate at this position and angle.
  bool clear_of(const world::scene::Gate& gate) const {
    const double half_drone_m = 0.046 * (std::cos(angle_rad) + std::abs(std::sin(angle_rad)));
    return crossed && std::abs(lateral_m) < 0.5 * gate.inner_m - half_drone_m;
  }
};

}  // namespace mebots::firmware_test
