// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/rigid_state.hpp"
#include "mebots/state/visitor.hpp"
#include "scene/solids.hpp"

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace mebots::world {

/// Looks from the body's centre along the body's -z axis and measures how far the next surface is:
/// ground, obstacles, gates. A new sample every 25 ms (the rate at which Crazyflie's firmware polls its
/// VL53L1X), held in between, with normal noise; `range_limit_m` where nothing is nearer. A sample that noise would
/// make negative reads 0.
class RangeSensor {
 public:
  static constexpr std::int64_t kPeriod_ns = 25'000'000;

  RangeSensor(const scene::Scene& scene, double noise_m, std::uint64_t seed);

  /// Of the noise of samples from now on. No part of the state: who holds the seed says it before every step.
  void reseed(std::uint64_t seed) { seed_ = seed; }

  /// The body is at `state` at time_ns; takes a sample when a new one is due.
  void update(std::int64_t time_ns, const RigidState& state);
  double reading_m() const { return reading_m_; }

  /// Without noise.
  double distance_m(const RigidState& state, std::int64_t time_ns = 0) const;

  void visit(state::Visitor& v);

 private:
  std::vector<scene::Solid> solids_;
  double limit_m_;
  double noise_m_;
  std::uint64_t seed_;
  std::int64_t sample_ = -1;  ///< number of the last sample since time 0
  double reading_m_ = 0.0;
};

}  // namespace mebots::world
