// SPDX-License-Identifier: Apache-2.0
#include "camera/pose.hpp"

#include <cmath>

namespace mebots::world::camera {

double Intrinsics::focal_length_px() const {
  return 0.5 * width / std::tan(0.5 * horizontal_field_of_view_rad);
}

Pose camera_pose(const Mounting& mounting, const Eigen::Vector3d& p_WB_m, const Eigen::Matrix3d& R_WB) {
  const double c = std::cos(mounting.pitch_rad);
  const double s = std::sin(mounting.pitch_rad);
  Eigen::Matrix3d R_BC;
  R_BC << c, 0.0, s,  //
      0.0, 1.0, 0.0,  //
      -s, 0.0, c;
  return Pose{p_WB_m + R_WB * mounting.p_BC_m, R_WB * R_BC, 0};
}

}  // namespace mebots::world::camera
