// SPDX-License-Identifier: Apache-2.0
#include "camera/culling.hpp"

#include "camera/outline.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::world::camera {
namespace {

using Eigen::Vector3d;

/// The number of faces per group. In a small group, the faces are near each other. With large groups, fewer groups are
/// tested.
constexpr std::size_t kMostFaces = 16;
/// A margin for rounding errors, which is added to the radius of a sphere.
constexpr double kMargin_m = 1e-6;

FaceGroup group_of(const std::vector<Face>& faces, std::size_t first, std::size_t end) {
  Vector3d low = faces[first].corners_W_m[0];
  Vector3d high = low;
  for (std::size_t i = first; i < end; ++i) {
    for (const Vector3d& corner : faces[i].corners_W_m) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
  }
  return {first, end, faces[first].mover, 0.5 * (low + high), 0.5 * (high - low).norm() + kMargin_m};
}

}  // namespace

PictureSides::PictureSides(const Intrinsics& intrinsics, int first_row, int end_row) {
  const double focal_length_px = intrinsics.focal_length_px();
  across_ = 0.5 * intrinsics.width / focal_length_px;
  lower_ = (0.5 * intrinsics.height - end_row) / focal_length_px;
  upper_ = (0.5 * intrinsics.height - first_row) / focal_length_px;
  const auto length = [](double slope) { return std::sqrt(1.0 + slope * slope); };
  per_across_ = length(across_);
  per_lower_ = length(lower_);
  per_upper_ = length(upper_);
}

bool PictureSides::leave_out(std::span<const Vector3d> corners_C_m) const {
  bool left = true;
  bool right = true;
  bool above = true;
  bool below = true;
  for (const Vector3d& p : corners_C_m) {
    left = left && p.y() > across_ * p.x();
    right = right && p.y() < -across_ * p.x();
    above = above && p.z() > upper_ * p.x();
    below = below && p.z() < lower_ * p.x();
  }
  return left || right || above || below;
}

bool PictureSides::leave_out(const Vector3d& p, double radius_m) const {
  return p.x() + radius_m < kNearPlane_m || std::abs(p.y()) - across_ * p.x() > radius_m * per_across_ ||
         p.z() - upper_ * p.x() > radius_m * per_upper_ || lower_ * p.x() - p.z() > radius_m * per_lower_;
}

FaceCovers::FaceCovers(const std::vector<Face>& all) {
  faces.reserve(all.size());
  for (const Face& face : all) {
    faces.push_back({face.normal_W, face.offset_m, face.light, static_cast<std::uint32_t>(corners_W_m.size()),
                     static_cast<std::uint32_t>(face.corners_W_m.size()), static_cast<std::uint32_t>(face.tile),
                     face.object});
    corners_W_m.insert(corners_W_m.end(), face.corners_W_m.begin(), face.corners_W_m.end());
  }
}

std::vector<FaceGroup> groups_of(const std::vector<Face>& faces) {
  std::vector<FaceGroup> groups;
  for (std::size_t first = 0; first < faces.size();) {
    std::size_t end = first + 1;
    while (end < faces.size() && end - first < kMostFaces && faces[end].mover == faces[first].mover) ++end;
    groups.push_back(group_of(faces, first, end));
    first = end;
  }
  return groups;
}

}  // namespace mebots::world::camera
