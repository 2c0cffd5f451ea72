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

/// The measurement of one time-of-flight sensor: the nearest surface, with limit, noise and resolution.
///
/// In mode `ray`, there is one ray, and the noise is constant. In mode `cone`, there are 17 rays in the field of view;
/// noise, resolution and period are from the drone's file.
class Ranging {
 public:
  struct Settings {
    RangeModel model = RangeModel::ray;
    double noise_m = 0.0;  ///< of a ray's samples
  };

  /// Throws mebots::Error if a cone is selected that the drone's file does not describe.
  Ranging(std::shared_ptr<const RayCaster> rays, const scene::Drone& drone, const Settings& settings);

  /// Returns the rays around a direction, as unit vectors.
  std::vector<Eigen::Vector3d> rays_around(const Eigen::Vector3d& direction_B) const;
  /// Returns the distance of the nearest surface on the rays from a point, without noise, at most the limit.
  double nearest_m(const Eigen::Vector3d& p_W_m, const Eigen::Quaterniond& q_WB,
                   std::span<const Eigen::Vector3d> rays_B, std::int64_t time_ns, const Others& others) const;
  /// Returns the reading for a distance. `gaussian` is a sample of the standard normal distribution. Readings that
  /// noise makes negative are 0.
  double reading_m(double distance_m, double gaussian) const;

  const RayCaster& rays() const { return *rays_; }
  double limit_m() const { return limit_m_; }
  /// Returns the data of the cone; empty in mode `ray`.
  const std::optional<scene::RangeData>& cone() const { return cone_; }

 private:
  std::shared_ptr<const RayCaster> rays_;
  std::optional<scene::RangeData> cone_;
  double limit_m_;
  double noise_m_;
};

}  // namespace mebots::world
