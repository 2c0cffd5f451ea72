// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/sample_clock.hpp"
#include "mebots/state/visitor.hpp"

#include <Eigen/Core>
#include <cstdint>

namespace mebots::world {

/// Measures contacts of the drone's body. A sample states whether the body touched something in a period, and the mean
/// force of all contacts in this period along the body's axes, with normal noise.
class ContactSensor {
 public:
  ContactSensor(double period_s, double noise_n, std::uint64_t seed);

  /// Saved states do not contain the seed, so DroneSensors sets it before every step.
  void reseed(std::uint64_t seed) { seed_ = seed; }

  /// Adds an inner step of dt that ends at time_ns. Takes a sample if a sample is due. `force_B_n` is the sum of all
  /// contact forces in the step.
  void update(std::int64_t time_ns, bool touches, const Eigen::Vector3d& force_B_n, double dt_s);

  bool touching() const { return touching_; }
  const Eigen::Vector3d& force_B_n() const { return force_B_n_; }

  void visit(state::Visitor& v);

 private:
  double noise_n_;
  SampleClock clock_;
  std::uint64_t seed_;
  bool touched_ = false;  ///< since the last sample
  Eigen::Vector3d impulse_B_n_s_ = Eigen::Vector3d::Zero();
  double gathered_s_ = 0.0;
  bool touching_ = false;
  Eigen::Vector3d force_B_n_ = Eigen::Vector3d::Zero();
};

}  // namespace mebots::world
