// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmu_world/variables.hpp"
#include "scene/scene.hpp"
#include "sensors/ray_caster.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace mebots::world {

/// A measurement of a time-of-flight sensor: the distance to the nearest surface, with limit, noise and resolution.
///
/// In mode `ray`, uses one ray and a constant noise. In mode `cone`, uses 17 rays in the field of view. The noise,
/// resolution and period are then those of the drone's file.
class Ranging {
 public:
  struct Settings {
    RangeModel model = RangeModel::ray;
    double noise_m = 0.0;  ///< of a ray's samples
  };

  /// Throws mebots::Error if `settings.model` is `cone`, but the drone's file does not describe a range sensor.
  Ranging(std::shared_ptr<const RayCaster> rays, const scene::Drone& drone, const Settings& settings);

  std::vector<Eigen::Vector3d> rays_around(const Eigen::Vector3d& direction_B) const;
  /// Returns the distance from a point to the nearest surface along the rays, without noise, at most the limit.
  double nearest_m(const Eigen::Vector3d& p_W_m, const Eigen::Quaterniond& q_WB,
                   std::span<const Eigen::Vector3d> rays_B, std::int64_t time_ns, const Others& others) const;
  /// Returns the reading for a distance. `gaussian` is a sample of the standard normal distribution. Negative readings
  /// become 0.
  double reading_m(double distance_m, double gaussian) const;

  const RayCaster& rays() const { return *rays_; }
  double limit_m() const { return limit_m_; }
  /// Empty in mode `ray`.
  const std::optional<scene::RangeData>& cone() const { return cone_; }

 private:
  std::shared_ptr<const RayCaster> rays_;
  std::optional<scene::RangeData> cone_;
  double limit_m_;
  double noise_m_;
};

}  // namespace mebots::world
