// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"
#include "fmu_world/variables.hpp"
#include "math/periods.hpp"
#include "mebots/state/visitor.hpp"
#include "scene/scene.hpp"

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

namespace mebots::world {

/// Looks from the body's centre along the body's -z axis and measures how far the next surface is: ground, obstacles,
/// gates. A sample is held until the next one is due; `range_limit_m` where nothing is nearer. A sample that noise
/// would make negative reads 0.
///
/// As a ray: a sample every 25 ms (the rate at which Crazyflie's firmware polls its VL53L1X), the same noise
/// everywhere. As a cone: what the drone's file says of rate, resolution and noise; the nearest surface in the field of
/// view, of which 17 rays are looked at.
class RangeSensor {
 public:
  static constexpr std::int64_t kPeriod_ns = 25'000'000;

  struct Settings {
    RangeModel model = RangeModel::ray;
    double noise_m = 0.0;  ///< of a ray's samples
  };

  /// Throws mebots::Error for a cone that the drone's file does not describe.
  RangeSensor(const scene::Scene& scene, const Settings& settings, std::uint64_t seed);

  /// Of the noise of samples from now on. No part of the state: who holds the seed says it before every step.
  void reseed(std::uint64_t seed) { seed_ = seed; }

  /// The body is at `state` at time_ns; takes a sample when a new one is due.
  void update(std::int64_t time_ns, const RigidState& state);
  double reading_m() const { return reading_m_; }
  std::int64_t sample() const { return sample_; }  ///< its number since time 0; kNoPeriod = none yet
  double limit_m() const { return limit_m_; }

  /// Along -z, without noise, at most the limit.
  double distance_m(const RigidState& state, std::int64_t time_ns = 0) const;
  /// The same without a limit: infinity where nothing is.
  double sight_m(const RigidState& state, std::int64_t time_ns) const;

  void visit(state::Visitor& v);

 private:
  double along_m(const RigidState& state, const Eigen::Vector3d& direction_B, std::int64_t time_ns) const;
  double nearest_in_cone_m(const RigidState& state, std::int64_t time_ns) const;

  std::vector<scene::Solid> solids_;
  std::optional<scene::RangeData> cone_;
  std::vector<Eigen::Vector3d> rays_B_;  ///< of the cone, unit vectors
  std::int64_t period_ns_ = kPeriod_ns;
  double limit_m_;
  double noise_m_;
  std::uint64_t seed_;
  std::int64_t sample_ = kNoPeriod;
  double reading_m_ = 0.0;
};

}  // namespace mebots::world
