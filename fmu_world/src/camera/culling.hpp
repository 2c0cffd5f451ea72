// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/geometry.hpp"
#include "camera/lens.hpp"

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// What of a scene cannot be in a picture, told before anything is projected.
namespace mebots::world::camera {

/// The four planes through the camera and the sides of a picture, or of some of its rows. What is wholly beyond one of
/// them covers no pixel: the outermost pixels' centres are half a pixel inside, which is far more than any rounding.
class PictureSides {
 public:
  PictureSides(const Intrinsics& intrinsics, int first_row, int end_row);

  /// Corners in the camera frame.
  bool leave_out(std::span<const Eigen::Vector3d> corners_C_m) const;
  /// Everything within `radius_m` of a point in the camera frame; also what is behind the camera.
  bool leave_out(const Eigen::Vector3d& middle_C_m, double radius_m) const;

 private:
  double across_;                              // left over ahead, of the left side; the right one has the negative
  double lower_, upper_;                       // up over ahead
  double per_across_, per_lower_, per_upper_;  // lengths of the planes' normals
};

/// What tells whether a face may be seen, and all of one without texture: few cache lines for thousands of faces.
struct FaceCover {
  Eigen::Vector3d normal_W;
  double offset_m;
  double light;
  std::uint32_t first_corner, corner_count;  // in FaceCovers::corners_W_m
  std::uint32_t tile;
};

/// Of all faces, in their order.
struct FaceCovers {
  explicit FaceCovers(const std::vector<Face>& faces);
  std::span<const Eigen::Vector3d> corners_of(const FaceCover& face) const {
    return {corners_W_m.data() + face.first_corner, face.corner_count};
  }
  std::vector<FaceCover> faces;
  std::vector<Eigen::Vector3d> corners_W_m;
};

/// Faces that follow each other, of one mover or of what stands, and a sphere around them.
struct FaceGroup {
  std::size_t first, end;  // in Geometry::faces
  std::size_t mover;
  Eigen::Vector3d middle_W_m;
  double radius_m;
};

/// All faces in groups, in their order.
std::vector<FaceGroup> groups_of(const std::vector<Face>& faces);

}  // namespace mebots::world::camera
