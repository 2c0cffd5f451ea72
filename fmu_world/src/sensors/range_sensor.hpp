// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"
#include "math/periods.hpp"
#include "mebots/state/visitor.hpp"
#include "sensors/others.hpp"
#include "sensors/ranging.hpp"

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

namespace mebots::world {

/// Measures the distance from the body's centre along the body's -z axis to the next surface: ground, obstacles, gates,
/// other drones. The output is constant between two samples. It is `range_limit_m` if no surface is nearer.
///
/// In mode `ray`, it takes a sample every 25 ms (the rate at which Crazyflie's firmware polls its VL53L1X); in mode
/// `cone`, with the period from the drone's file.
class RangeSensor {
 public:
  static constexpr std::int64_t kPeriod_ns = 25'000'000;

  using Settings = Ranging::Settings;

  /// Throws mebots::Error if a cone is selected that the drone's file does not describe.
  RangeSensor(std::shared_ptr<const RayCaster> rays, const scene::Drone& drone, const Settings& settings,
              std::uint64_t seed);

  /// Sets the seed for the noise of later samples. Saved states do not contain it, so DroneSensors sets it before
  /// every step.
  void reseed(std::uint64_t seed) { seed_ = seed; }

  /// Updates the sensor with the body at `state` at time_ns; takes a sample when one is due.
  void update(std::int64_t time_ns, const RigidState& state, const Others& others = {});
  double reading_m() const { return reading_m_; }
  std::int64_t sample() const { return sample_; }  ///< number since time 0; kNoPeriod = none yet
  double limit_m() const { return ranging_.limit_m(); }

  /// Returns the distance along -z, without noise, limited to range_limit_m.
  double distance_m(const RigidState& state, std::int64_t time_ns = 0, const Others& others = {}) const;
  /// Returns the distance along -z without noise and without limit; infinity if there is no surface.
  double sight_m(const RigidState& state, std::int64_t time_ns, const Others& others = {}) const;

  void visit(state::Visitor& v);

 private:
  Ranging ranging_;
  std::vector<Eigen::Vector3d> rays_B_;
  std::int64_t period_ns_ = kPeriod_ns;
  std::uint64_t seed_;
  std::int64_t sample_ = kNoPeriod;
  double reading_m_ = 0.0;
};

}  // namespace mebots::world
