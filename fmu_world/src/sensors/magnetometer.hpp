// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/sample_clock.hpp"
#include "mebots/state/visitor.hpp"
#include "scene/sensor_data.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>

namespace mebots::world {

/// Measures the flux density of a uniform field along the body's axes: truth + constant bias + normal noise, rounded to
/// the resolution and limited to the sensor's range. Ignores the currents of the motors.
class Magnetometer {
 public:
  Magnetometer(const scene::MagnetometerData& data, const Eigen::Vector3d& field_W_t, std::uint64_t seed);

  /// Saved states do not contain the seed, so DroneSensors sets it before every step.
  void reseed(std::uint64_t seed) { seed_ = seed; }

  void update(std::int64_t time_ns, const Eigen::Quaterniond& q_WB);

  const Eigen::Vector3d& field_B_t() const { return field_B_t_; }

  void visit(state::Visitor& v);

 private:
  scene::MagnetometerData data_;
  Eigen::Vector3d field_W_t_;
  SampleClock clock_;
  std::uint64_t seed_;
  Eigen::Vector3d field_B_t_ = Eigen::Vector3d::Zero();
};

}  // namespace mebots::world
