// SPDX-License-Identifier: Apache-2.0
#include "crazyflie/kalman.hpp"

#include "dynamics/rigid_world.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::world::crazyflie {
namespace {

constexpr int kPosition = 0;
constexpr int kVelocity = 3;
constexpr int kAttitude = 6;

// Standard deviations of the state at the start, of unmodelled accelerations, and of the gyroscope.
constexpr double kStartPosition_xy_m = 100.0;
constexpr double kStartPosition_z_m = 1.0;
constexpr double kStartVelocity_m_per_s = 0.01;
constexpr double kStartAttitude_rad = 0.01;
constexpr double kAcceleration_xy_m_per_s2 = 0.5;
constexpr double kAcceleration_z_m_per_s2 = 1.0;
constexpr double kGyroscope_rad_per_s = 0.1;
/// On the ground, each prediction replaces the attitude by a weighted mean of the attitude and the initial attitude.
/// This is the weight of the initial attitude.
constexpr double kReversion = 0.001;

constexpr double kLeastVariance = 1e-6;
constexpr double kMostVariance = 100.0;

/// The least height in the prediction of a flow measurement.
constexpr double kLeastHeight_m = 0.1;
/// Half the opening angle of the distance sensor's cone in the filter: 7.5 degrees.
constexpr double kHalfCone_rad = 0.130899693899575;
/// Standard deviation at distance d: kRangeDeviation_m (1 + exp(kRangeGrowth_per_m (d - kRangeFrom_m))).
constexpr double kRangeDeviation_m = 0.0025;
constexpr double kRangeFrom_m = 2.5;
constexpr double kRangeGrowth_per_m = 2.921350978;  // log(0.2 / 0.0025) / (4 - 2.5)

Eigen::Matrix3d cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// Returns the second-order matrix that rotates the covariance of the attitude error with the attitude. `half_rad` is
/// half the rotation.
Eigen::Matrix3d turned_by(const Eigen::Vector3d& half_rad) {
  const Eigen::Matrix3d d = cross(half_rad);
  return Eigen::Matrix3d::Identity() - d + 0.5 * d.lazyProduct(d);
}

Eigen::Quaterniond rotation_by(const Eigen::Vector3d& angle_rad) {
  const double angle = angle_rad.norm();
  if (angle == 0.0) return Eigen::Quaterniond::Identity();
  const Eigen::Vector3d axis = std::sin(0.5 * angle) / angle * angle_rad;
  return {std::cos(0.5 * angle), axis.x(), axis.y(), axis.z()};
}

double squared(double x) {
  return x * x;
}

}  // namespace

Kalman::Kalman(const scene::FlowData& flow, const RigidState& start)
    : flow_(flow), first_q_WB_(start.q_WB), position_m_(start.p_WB_m), q_WB_(start.q_WB) {
  Vector deviations;
  deviations << kStartPosition_xy_m, kStartPosition_xy_m, kStartPosition_z_m, kStartVelocity_m_per_s,
      kStartVelocity_m_per_s, kStartVelocity_m_per_s, kStartAttitude_rad, kStartAttitude_rad, kStartAttitude_rad;
  covariance_.diagonal() = deviations.cwiseAbs2();
  bound_covariance();
}

double Kalman::deviation(int state) const {
  return std::sqrt(covariance_(state, state));
}

void Kalman::turn_covariance(const Matrix& by) {
  const Matrix half = by.lazyProduct(covariance_);
  covariance_ = half.lazyProduct(by.transpose());
}

void Kalman::bound_covariance() {
  for (int i = 0; i < kStates; ++i) {
    for (int j = i; j < kStates; ++j) {
      double value = std::min(0.5 * (covariance_(i, j) + covariance_(j, i)), kMostVariance);
      if (i == j) value = std::max(value, kLeastVariance);
      covariance_(i, j) = covariance_(j, i) = value;
    }
  }
}

void Kalman::predict(const Eigen::Vector3d& force_m_per_s2, const Eigen::Vector3d& rate_rad_per_s, bool flying,
                     double dt_s) {
  const Eigen::Matrix3d R_WB = q_WB_.toRotationMatrix();
  const Eigen::Vector3d up_B = R_WB.row(2);
  const Eigen::Vector3d force_B = flying ? Eigen::Vector3d(0.0, 0.0, force_m_per_s2.z()) : force_m_per_s2;

  Matrix a = Matrix::Identity();
  a.block<3, 3>(kPosition, kVelocity) = dt_s * R_WB;
  a.block<3, 3>(kPosition, kAttitude) = -dt_s * R_WB.lazyProduct(cross(velocity_B_m_per_s_));
  a.block<3, 3>(kVelocity, kVelocity) -= dt_s * cross(rate_rad_per_s);
  a.block<3, 3>(kVelocity, kAttitude) = -dt_s * kGravity_m_per_s2 * cross(up_B);
  a.block<3, 3>(kAttitude, kAttitude) = turned_by(0.5 * dt_s * rate_rad_per_s);
  turn_covariance(a);
  bound_covariance();

  const Eigen::Vector3d gravity_W{0.0, 0.0, -kGravity_m_per_s2};
  position_m_ += dt_s * (R_WB * velocity_B_m_per_s_) + 0.5 * dt_s * dt_s * (R_WB * force_B + gravity_W);
  velocity_B_m_per_s_ += dt_s * (force_B - rate_rad_per_s.cross(velocity_B_m_per_s_) - kGravity_m_per_s2 * up_B);
  q_WB_ = q_WB_ * rotation_by(dt_s * rate_rad_per_s);
  if (!flying) q_WB_.coeffs() = (1.0 - kReversion) * q_WB_.coeffs() + kReversion * first_q_WB_.coeffs();
  q_WB_.normalize();
}

void Kalman::add_process_noise(double dt_s) {
  const double xy = kAcceleration_xy_m_per_s2 * dt_s;
  const double z = kAcceleration_z_m_per_s2 * dt_s;
  const double turn = kGyroscope_rad_per_s * dt_s;
  Vector deviations;
  deviations << xy * dt_s, xy * dt_s, z * dt_s, xy, xy, z, turn, turn, turn;
  covariance_.diagonal() += deviations.cwiseAbs2();
  bound_covariance();
}

void Kalman::update(const Vector& h, double error, double deviation) {
  const Vector ph = covariance_.lazyProduct(h);
  const double variance = squared(deviation);
  const Vector gain = ph / (h.dot(ph) + variance);
  position_m_ += error * gain.segment<3>(kPosition);
  velocity_B_m_per_s_ += error * gain.segment<3>(kVelocity);
  attitude_error_rad_ += error * gain.segment<3>(kAttitude);
  const Matrix keep = Matrix::Identity() - gain.lazyProduct(h.transpose());
  turn_covariance(keep);
  covariance_ += variance * gain.lazyProduct(gain.transpose());
  bound_covariance();
}

void Kalman::measure_flow(const std::array<double, 2>& pixels, const Eigen::Vector3d& rate_rad_per_s, double dt_s) {
  const double scale = dt_s * flow_.pixels_per_rad;
  for (int i = 0; i < 2; ++i) {
    const double height_m = std::max(position_m_.z(), kLeastHeight_m);
    const double per_m = q_WB_.toRotationMatrix()(2, 2) / height_m;
    const double turning = i == 0 ? -rate_rad_per_s.y() : rate_rad_per_s.x();
    Vector h = Vector::Zero();
    h[kPosition + 2] = -scale * velocity_B_m_per_s_[i] * per_m / height_m;
    h[kVelocity + i] = scale * per_m;
    const double expected = scale * (velocity_B_m_per_s_[i] * per_m + turning);
    update(h, pixels[static_cast<std::size_t>(i)] - expected, flow_.noise_pixels);
  }
}

void Kalman::measure_distance(double distance_m) {
  const double upright = q_WB_.toRotationMatrix()(2, 2);
  constexpr double kLeastUpright = 0.1;
  if (upright <= kLeastUpright) return;
  const double angle = std::max(0.0, std::acos(std::min(upright, 1.0)) - kHalfCone_rad);
  const double per_height = 1.0 / std::cos(angle);
  Vector h = Vector::Zero();
  h[kPosition + 2] = per_height;
  const double deviation_m = kRangeDeviation_m * (1.0 + std::exp(kRangeGrowth_per_m * (distance_m - kRangeFrom_m)));
  update(h, distance_m - per_height * position_m_.z(), deviation_m);
}

void Kalman::finish() {
  Matrix a = Matrix::Identity();
  a.block<3, 3>(kAttitude, kAttitude) = turned_by(0.5 * attitude_error_rad_);
  q_WB_ = (q_WB_ * rotation_by(attitude_error_rad_)).normalized();
  attitude_error_rad_.setZero();
  turn_covariance(a);
  bound_covariance();
}

void Kalman::visit(state::Visitor& v) {
  constexpr auto kValues = static_cast<std::size_t>(kStates) * kStates;
  v("first_q_WB", numbers(first_q_WB_));
  v("position_m", numbers(position_m_));
  v("velocity_B_m_per_s", numbers(velocity_B_m_per_s_));
  v("attitude_error_rad", numbers(attitude_error_rad_));
  v("q_WB", numbers(q_WB_));
  v("covariance", std::span<double, kValues>(covariance_.data(), kValues));
}

}  // namespace mebots::world::crazyflie
