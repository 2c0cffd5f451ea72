// SPDX-License-Identifier: Apache-2.0
#include "scene/scene.hpp"

#include <cmath>

namespace mebots::world::scene {

std::array<Box, 4> Gate::beams() const {
  const double width = 0.5 * (outer_m - inner_m);
  const double middle = 0.25 * (outer_m + inner_m);
  const Eigen::Vector3d left_W{-std::sin(yaw_rad), std::cos(yaw_rad), 0.0};
  const Eigen::Vector3d up_W = Eigen::Vector3d::UnitZ();
  const auto beam = [&](const char* which, const Eigen::Vector3d& offset_W, double along_y, double along_z) {
    return Box{name + " " + which, p_W_m + offset_W, {thickness_m, along_y, along_z}, yaw_rad, texture};
  };
  return {beam("left", middle * left_W, width, outer_m), beam("right", -middle * left_W, width, outer_m),
          beam("top", middle * up_W, inner_m, width), beam("bottom", -middle * up_W, inner_m, width)};
}

}  // namespace mebots::world::scene
