// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/geometry.hpp"
#include "camera/lens.hpp"

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace mebots::world::camera {

/// The four planes through the camera and the sides of a picture, or of some rows of the picture. A face that is
/// completely outside of one plane covers no pixel. Rounding errors cannot change this: the centres of the outermost
/// pixels are half a pixel away from the planes.
class PictureSides {
 public:
  PictureSides(const Intrinsics& intrinsics, int first_row, int end_row);

  /// Return true if an object is certainly outside of the picture: a face with these corners in the camera frame, or a
  /// sphere in the camera frame. If the result is false, the object may still be invisible.
  bool leave_out(std::span<const Eigen::Vector3d> corners_C_m) const;
  bool leave_out(const Eigen::Vector3d& middle_C_m, double radius_m) const;

 private:
  double across_;         // left over ahead of the left side; that of the right side is its negative
  double lower_, upper_;  // up over ahead
  double per_across_, per_lower_, per_upper_;  // lengths of the planes' normals
};

/// The data of a face that decide its visibility, and all data that a face without texture needs. The structure is
/// compact, so that a loop over thousands of faces reads few cache lines.
struct FaceCover {
  Eigen::Vector3d normal_W;
  double offset_m;
  double light;
  std::uint32_t first_corner, corner_count;  // in FaceCovers::corners_W_m
  std::uint32_t tile;
  std::uint32_t object;
};

/// The FaceCover of each face, in the order of the faces.
struct FaceCovers {
  explicit FaceCovers(const std::vector<Face>& faces);
  std::span<const Eigen::Vector3d> corners_of(const FaceCover& face) const {
    return {corners_W_m.data() + face.first_corner, face.corner_count};
  }
  std::vector<FaceCover> faces;
  std::vector<Eigen::Vector3d> corners_W_m;
};

/// Consecutive faces with the same mover, or without a mover, and a sphere around them.
struct FaceGroup {
  std::size_t first, end;  // in Geometry::faces
  std::size_t mover;
  Eigen::Vector3d middle_W_m;
  double radius_m;
};

/// Divides all faces into groups and keeps their order.
std::vector<FaceGroup> groups_of(const std::vector<Face>& faces);

}  // namespace mebots::world::camera
