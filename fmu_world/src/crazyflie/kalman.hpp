// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"
#include "mebots/state/visitor.hpp"
#include "scene/scene.hpp"

#include <Eigen/Geometry>
#include <array>

namespace mebots::world::crazyflie {

/// An extended Kalman filter for position, velocity in body axes, and attitude error. After measurements, the error is
/// added to the attitude, as in M. W. Mueller, M. Hamer, R. D'Andrea, "Fusing ultra-wideband range measurements with
/// accelerometers and rate gyroscopes for quadrocopter state estimation", ICRA 2015. The covariance is rotated with the
/// attitude, as in M. W. Mueller, M. Hehn, R. D'Andrea, "Covariance correction step for Kalman filtering with an
/// attitude", JGCD 2016. The equations of motion are x' = R v, v' = f - w x v - g R^T e_z, R' = R [w]x. The measurement
/// equations of flow and distance, and all numbers, are those of the Crazyflie's firmware (crazyflie-firmware, commit
/// 2a18fc29, kalman_core_params_defaults.h, mm_flow.c, mm_tof.c, zranger2.c).
class Kalman {
 public:
  /// Starts at rest with a known position and attitude.
  Kalman(const scene::FlowData& flow, const RigidState& start);

  /// Predicts the state after dt from the mean specific force and body rate during dt. In flight, ignores the force
  /// along x and y, because it is drag and contains no information about the attitude. On the ground, also moves the
  /// attitude a little towards the initial attitude.
  void predict(const Eigen::Vector3d& force_m_per_s2, const Eigen::Vector3d& rate_rad_per_s, bool flying, double dt_s);
  /// Adds the process noise of the time dt to the covariance. Must be called once per millisecond: the standard
  /// deviation is proportional to dt, so the result depends on the interval of the calls.
  void add_process_noise(double dt_s);
  /// Corrects the state with a flow measurement: the motion of the picture during dt. `rate_rad_per_s` is the body rate
  /// during dt.
  void measure_flow(const std::array<double, 2>& pixels, const Eigen::Vector3d& rate_rad_per_s, double dt_s);
  void measure_distance(double distance_m);
  /// Adds the estimated attitude error to the attitude. Call this function after measurements, before the state is
  /// read.
  void finish();

  const Eigen::Vector3d& position_m() const { return position_m_; }
  const Eigen::Quaterniond& attitude() const { return q_WB_; }
  Eigen::Vector3d velocity_W_m_per_s() const { return q_WB_ * velocity_B_m_per_s_; }
  /// Returns the standard deviation of one element of the state: position, velocity or attitude error.
  double deviation(int state) const;

  void visit(state::Visitor& v);

 private:
  static constexpr int kStates = 9;
  using Vector = Eigen::Matrix<double, kStates, 1>;
  using Matrix = Eigen::Matrix<double, kStates, kStates>;

  void turn_covariance(const Matrix& by);
  void bound_covariance();
  void update(const Vector& h, double error, double deviation);

  scene::FlowData flow_;
  Eigen::Quaterniond first_q_WB_;
  Eigen::Vector3d position_m_;
  Eigen::Vector3d velocity_B_m_per_s_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d attitude_error_rad_ = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_WB_;
  Matrix covariance_ = Matrix::Zero();
};

}  // namespace mebots::world::crazyflie
