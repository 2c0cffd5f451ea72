// SPDX-License-Identifier: Apache-2.0
#include "scene/scene.hpp"

#include <cmath>

namespace mebots::world::scene {

std::array<Box, 4> Gate::beams() const {
  const double side = 0.5 * (outer_m - inner_m);
  const double sill = 0.5 * (frame_height_m() - opening_height_m());
  const double across = 0.25 * (outer_m + inner_m);
  const double up = 0.25 * (frame_height_m() + opening_height_m());
  const bool upright = pitch_rad == 0.0 && roll_rad == 0.0;
  const Eigen::Matrix3d R_WG = attitude_of(*this).toRotationMatrix();
  const Eigen::Vector3d left_W =
      upright ? Eigen::Vector3d{-std::sin(yaw_rad), std::cos(yaw_rad), 0.0} : Eigen::Vector3d(R_WG.col(1));
  const Eigen::Vector3d up_W = upright ? Eigen::Vector3d(Eigen::Vector3d::UnitZ()) : Eigen::Vector3d(R_WG.col(2));
  const auto beam = [&](const char* which, const Eigen::Vector3d& offset_W, double along_y, double along_z) {
    return Box{name + " " + which,
               p_W_m + offset_W,
               {thickness_m, along_y, along_z},
               yaw_rad,
               texture,
               pitch_rad,
               roll_rad,
               {}};
  };
  return {beam("left", across * left_W, side, frame_height_m()),
          beam("right", -across * left_W, side, frame_height_m()), beam("top", up * up_W, inner_m, sill),
          beam("bottom", -up * up_W, inner_m, sill)};
}

}  // namespace mebots::world::scene
