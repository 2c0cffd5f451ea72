// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"
#include "fmu_world/variables.hpp"
#include "math/periods.hpp"
#include "mebots/state/visitor.hpp"
#include "scene/scene.hpp"
#include "sensors/others.hpp"

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

namespace mebots::world {

/// Measures the distance from the body's centre along the body's -z axis to the next surface: ground, obstacles, gates,
/// other drones. The output is constant between two samples. It is `range_limit_m` if no surface is nearer. Samples
/// that noise makes negative are 0.
///
/// In mode `ray`, it takes a sample every 25 ms (the rate at which Crazyflie's firmware polls its VL53L1X), with
/// constant noise. In mode `cone`, it measures the nearest surface on 17 rays of the field of view, with rate,
/// resolution and noise from the drone's file.
class RangeSensor {
 public:
  static constexpr std::int64_t kPeriod_ns = 25'000'000;

  struct Settings {
    RangeModel model = RangeModel::ray;
    double noise_m = 0.0;  ///< of a ray's samples
  };

  /// Throws mebots::Error if a cone is selected that the drone's file does not describe.
  RangeSensor(const scene::Scene& scene, const scene::Drone& drone, const Settings& settings, std::uint64_t seed);

  /// Sets the seed for the noise of later samples. It is not part of the state: its owner sets it before every step.
  void reseed(std::uint64_t seed) { seed_ = seed; }

  /// Updates the sensor with the body at `state` at time_ns; takes a sample when one is due.
  void update(std::int64_t time_ns, const RigidState& state, const Others& others = {});
  double reading_m() const { return reading_m_; }
  std::int64_t sample() const { return sample_; }  ///< number since time 0; kNoPeriod = none yet
  double limit_m() const { return limit_m_; }

  /// Returns the distance along -z, without noise, limited to range_limit_m.
  double distance_m(const RigidState& state, std::int64_t time_ns = 0, const Others& others = {}) const;
  /// Returns the distance along -z without noise and without limit; infinity if there is no surface.
  double sight_m(const RigidState& state, std::int64_t time_ns, const Others& others = {}) const;

  void visit(state::Visitor& v);

 private:
  double along_m(const RigidState& state, const Eigen::Vector3d& direction_B, std::int64_t time_ns,
                 const Others& others) const;
  double nearest_in_cone_m(const RigidState& state, std::int64_t time_ns, const Others& others) const;

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
