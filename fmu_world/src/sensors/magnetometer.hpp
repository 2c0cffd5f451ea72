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
/// the resolution and limited to the sensor's range. The currents of the motors have no influence.
class Magnetometer {
 public:
  Magnetometer(const scene::MagnetometerData& data, const Eigen::Vector3d& field_W_t, std::uint64_t seed);

  /// Sets the seed. Saved states do not contain it, so DroneSensors sets it before every step.
  void reseed(std::uint64_t seed) { seed_ = seed; }

  /// Takes a sample if one is due at time_ns.
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
