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
/// other drones. The output is constant between two samples. If no surface is nearer than `range_limit_m`, the measured
/// distance is this limit. In mode `ray`, noise is added to the limit, too.
///
/// In mode `ray`, takes a sample every 25 ms, the interval at which the Crazyflie's firmware reads its VL53L1X. In mode
/// `cone`, takes a sample in each period from the drone's file.
class RangeSensor {
 public:
  static constexpr std::int64_t kPeriod_ns = 25'000'000;

  using Settings = Ranging::Settings;

  /// Throws mebots::Error if `settings.model` is `cone`, but the drone's file does not describe a range sensor.
  RangeSensor(std::shared_ptr<const RayCaster> rays, const scene::Drone& drone, const Settings& settings,
              std::uint64_t seed);

  /// Saved states do not contain the seed, so DroneSensors sets it before every step.
  void reseed(std::uint64_t seed) { seed_ = seed; }

  /// If a sample is due at time_ns, takes it with the body at `state`.
  void update(std::int64_t time_ns, const RigidState& state, const Others& others = {});
  double reading_m() const { return reading_m_; }
  std::int64_t sample() const { return sample_; }  ///< number since time 0; kNoPeriod = none yet
  double limit_m() const { return ranging_.limit_m(); }

  /// Returns the distance along -z without noise, at most range_limit_m.
  double distance_m(const RigidState& state, std::int64_t time_ns = 0, const Others& others = {}) const;
  /// Returns the distance along -z without noise and without limit. If there is no surface, returns infinity.
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
