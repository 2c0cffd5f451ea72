// SPDX-License-Identifier: Apache-2.0
#include "camera/culling.hpp"

#include "camera/outline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

namespace {

using Eigen::Vector3d;
using mebots::world::camera::Face;
using mebots::world::camera::groups_of;
using mebots::world::camera::Intrinsics;
using mebots::world::camera::kMaxOutlineCorners;
using mebots::world::camera::Outline;
using mebots::world::camera::PictureSides;

constexpr Intrinsics kCamera{120, 90, 1.5};

/// Generates triangles of all sizes around the camera. Some cross the camera's plane or the picture's sides.
class Triangles {
 public:
  std::vector<Vector3d> next() {
    const Vector3d middle(away_(random_), away_(random_), away_(random_));
    const double size = std::exp2(exponent_(random_));
    std::vector<Vector3d> corners;
    for (int i = 0; i < 3; ++i)
      corners.emplace_back(middle + size * Vector3d(one_(random_), one_(random_), one_(random_)));
    return corners;
  }

 private:
  std::mt19937 random_{7};
  std::uniform_real_distribution<double> away_{-3.0, 3.0};
  std::uniform_real_distribution<double> one_{-1.0, 1.0};
  std::uniform_real_distribution<double> exponent_{-8.0, 1.0};
};

bool covers_a_pixel(const std::vector<Vector3d>& corners_C, int first_row, int end_row) {
  std::array<Outline::Edge, kMaxOutlineCorners> edges;
  const Outline outline({kCamera.focal_length_px(), kCamera.width, kCamera.height}, corners_C, edges);
  bool covered = false;
  for (int row = first_row; row < end_row; ++row)
    outline.spans(row, row + 1, [&](int, int begin, int end) { covered = covered || begin < end; });
  return covered;
}

Face face_with(std::vector<Vector3d> corners) {
  Face face;
  for (Vector3d* vector : {&face.normal_W, &face.u_axis_W, &face.v_axis_W, &face.texture_origin_W_m}) vector->setZero();
  face.corners_W_m = std::move(corners);
  return face;
}

TEST(CameraCulling, KeepsEveryFaceThatCoversAPixel) {
  Triangles triangles;
  int covering = 0;
  int left_out = 0;
  for (int i = 0; i < 200000; ++i) {
    const std::vector<Vector3d> corners = triangles.next();
    const int first_row = i % 3 == 0 ? 0 : 8 * (i % 11);
    const int end_row = i % 3 == 0 ? kCamera.height : first_row + 8;
    const PictureSides sides(kCamera, first_row, end_row);
    const auto group = groups_of({face_with(corners)}).at(0);
    const bool out = sides.leave_out(corners) || sides.leave_out(group.middle_W_m, group.radius_m);
    left_out += out ? 1 : 0;
    if (!covers_a_pixel(corners, first_row, end_row)) continue;
    ++covering;
    ASSERT_FALSE(out) << "triangle " << i;
  }
  EXPECT_GT(covering, 3000);
  EXPECT_GT(left_out, 120000);
}

TEST(CameraCulling, GroupsHoldAllFacesInOrderAndNoneMixesMovers) {
  std::vector<Face> faces;
  for (std::size_t i = 0; i < 100; ++i) {
    const auto x = static_cast<double>(i);
    faces.push_back(face_with({Vector3d(x, 0, 0), Vector3d(x, 1, 0), Vector3d(x, 0, 2)}));
    faces.back().mover = i < 40 ? Face::kStatic : i / 50;
  }
  std::size_t next = 0;
  for (const auto& group : groups_of(faces)) {
    EXPECT_EQ(group.first, next);
    next = group.end;
    for (std::size_t i = group.first; i < group.end; ++i) {
      EXPECT_EQ(faces[i].mover, group.mover);
      for (const Vector3d& corner : faces[i].corners_W_m) EXPECT_LE((corner - group.middle_W_m).norm(), group.radius_m);
    }
  }
  EXPECT_EQ(next, faces.size());
}

}  // namespace
