// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"
#include "math/periods.hpp"
#include "mebots/state/visitor.hpp"

#include <Eigen/Core>
#include <cstdint>

namespace mebots::world {

/// An accelerometer and a gyroscope at the body's centre along its axes. They take a sample every millisecond.
///
///   reading = truth + bias + normal noise
///
/// The true values are the body rate, and the mean specific force in the last inner step. The specific force is the sum
/// of all forces except gravity, divided by the mass. Each bias is constant, and is drawn once from the seed with a
/// standard deviation. The noise depends only on seed and time.
class Imu {
 public:
  static constexpr std::int64_t kPeriod_ns = 1'000'000;

  struct Settings {
    double acceleration_noise_m_per_s2 = 0.0;  ///< standard deviation of a sample
    double acceleration_bias_m_per_s2 = 0.0;   ///< of the bias
    double rate_noise_rad_per_s = 0.0;
    double rate_bias_rad_per_s = 0.0;
  };

  /// Throws mebots::Error if a standard deviation is negative or not finite.
  Imu(const Settings& settings, std::uint64_t seed);

  /// Saved states do not contain the seed, so DroneSensors sets it before every step.
  void reseed(std::uint64_t seed) { seed_ = seed; }

  /// Updates the sensors after the body has moved from one state to another within dt. The motion ends at time_ns.
  void update(std::int64_t time_ns, const RigidState& from, const RigidState& to, double dt_s);

  const Eigen::Vector3d& acceleration_m_per_s2() const { return acceleration_m_per_s2_; }
  std::int64_t sample() const { return sample_; }  ///< number of the last sample since time 0; kNoPeriod = none yet
  const Eigen::Vector3d& rate_rad_per_s() const { return rate_rad_per_s_; }

  void visit(state::Visitor& v);

 private:
  Eigen::Vector3d disturbed(const Eigen::Vector3d& truth, double noise, double bias, int first,
                            std::int64_t sample) const;

  Settings settings_;
  std::uint64_t seed_;
  std::int64_t sample_ = kNoPeriod;
  Eigen::Vector3d acceleration_m_per_s2_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_rad_per_s_ = Eigen::Vector3d::Zero();
};

}  // namespace mebots::world
