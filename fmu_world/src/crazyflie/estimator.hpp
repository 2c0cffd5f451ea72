// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "crazyflie/kalman.hpp"
#include "crazyflie/low_pass.hpp"
#include "dynamics/airframe.hpp"
#include "mebots/state/visitor.hpp"
#include "sensors/flow_sensor.hpp"
#include "sensors/imu.hpp"
#include "sensors/range_sensor.hpp"

#include <Eigen/Core>
#include <cstdint>

namespace mebots::world::crazyflie {

/// Estimates the state from sensor values with a Kalman filter, at the firmware's rates. Filters the IMU's samples with
/// low-pass filters (gyroscope 80 Hz, accelerometer 30 Hz). Predicts the state every 10 ms from the means of the
/// filtered samples. Uses measurements of flow and distance when they arrive. Starts with the true position and
/// attitude.
class Estimator {
 public:
  static constexpr std::int64_t kPredictionPeriod_ns = 10'000'000;

  Estimator(const scene::FlowData& flow, const RigidState& start, std::int64_t start_ns);

  void update(std::int64_t time_ns, const Imu& imu, const FlowSensor& flow, const RangeSensor& range, bool flying);

  const RigidState& state() const { return state_; }

  void visit(state::Visitor& v);

 private:
  void take_imu(std::int64_t time_ns, const Imu& imu);
  bool predict(std::int64_t time_ns, bool flying);

  Kalman filter_;
  LowPass rate_filter_;
  LowPass force_filter_;
  RigidState state_;
  Eigen::Vector3d rate_rad_per_s_ = Eigen::Vector3d::Zero();  ///< last filtered sample
  Eigen::Vector3d rate_sum_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_sum_ = Eigen::Vector3d::Zero();
  std::int64_t samples_ = 0;  ///< number of IMU samples in the sums
  std::int64_t imu_sample_ = kNoPeriod;
  std::int64_t flow_sample_ = kNoPeriod;
  std::int64_t range_sample_ = kNoPeriod;
  std::int64_t noise_ns_;       ///< time up to which process noise has been added
  std::int64_t prediction_ns_;  ///< time of the last prediction
};

}  // namespace mebots::world::crazyflie
