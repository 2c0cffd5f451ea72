// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.hpp"
#include "sensors/others.hpp"

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace mebots::world {

/// Computes where rays meet the ground, the solids of a scene and drones. Constant after construction, so drones may
/// share a caster.
class RayCaster {
 public:
  explicit RayCaster(const scene::Scene& scene);

  /// Returns the distance from a point along a unit vector to the next surface at a time. If the ray meets no surface,
  /// returns infinity. A ray from inside of a solid does not meet this solid.
  double distance_m(const Eigen::Vector3d& p_W_m, const Eigen::Vector3d& direction_W, std::int64_t time_ns,
                    const Others& others) const;

 private:
  std::vector<scene::Solid> solids_;
};

}  // namespace mebots::world
