// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace mebots::world::camera {

/// Pinhole camera with square pixels, its axis through the middle of the picture.
struct Intrinsics {
  int width = 320;                                ///< pixels, 8..2048
  int height = 320;                               ///< pixels, 8..2048
  double horizontal_field_of_view_rad = 1.51844;  ///< full angle over the width, 0.1..3.0

  /// Focal length in pixels: (width / 2) / tan(half the field of view).
  double focal_length_px() const;
};

/// Where the camera is. Camera frame C, as the body's: x forward along the optical axis, y left, z up.
/// A point (x, y, z) in C with x > 0 appears at column width/2 - f y/x and row height/2 - f z/x, counted
/// from the picture's top left corner. The centre of the top left pixel is (0.5, 0.5).
struct Pose {
  Eigen::Vector3d p_WC_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d R_WC = Eigen::Matrix3d::Identity();
  std::int64_t time_ns = 0;  ///< when: what moves is seen where it is then
};

/// How the camera sits in the drone's body.
struct Mounting {
  Eigen::Vector3d p_BC_m{0.027, 0.0, 0.012};
  double pitch_rad = 0.0;  ///< about the body's y, positive looks down
};

/// The camera's pose from the body's.
Pose camera_pose(const Mounting& mounting, const Eigen::Vector3d& p_WB_m, const Eigen::Matrix3d& R_WB);

}  // namespace mebots::world::camera
