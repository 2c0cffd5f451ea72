// SPDX-License-Identifier: Apache-2.0
#include "camera/outline.hpp"

#include "mebots/assert.hpp"

#include <cmath>

namespace mebots::world::camera {
namespace {

using Eigen::Vector3d;

/// Guard band: what is further than this from the picture's middle is cut off, which keeps the integers small.
constexpr double kGuard_px = 32768.0;

struct Polygon {
  std::array<Vector3d, kMaxOutlineCorners> corners;
  int count = 0;
};

/// The plane distance > 0 keeps a corner.
struct ClipPlane {
  Vector3d normal;
  double offset;
  double distance(const Vector3d& p) const { return normal.dot(p) - offset; }
};

Polygon clipped(const Polygon& polygon, const ClipPlane& plane) {
  Polygon kept;
  for (int i = 0; i < polygon.count; ++i) {
    const Vector3d& a = polygon.corners[i];
    const Vector3d& b = polygon.corners[(i + 1) % polygon.count];
    const double da = plane.distance(a);
    const double db = plane.distance(b);
    if (da >= 0.0) kept.corners[kept.count++] = a;
    // Always from the kept corner to the lost one: two polygons walk their common edge in opposite
    // directions and must get the same bits.
    if (da >= 0.0 && db < 0.0) kept.corners[kept.count++] = a + (da / (da - db)) * (b - a);
    if (da < 0.0 && db >= 0.0) kept.corners[kept.count++] = b + (db / (db - da)) * (a - b);
    if (kept.count > kMaxOutlineCorners - 2) break;  // a convex polygon never gets there
    MEBOTS_ASSERT(kept.count < kMaxOutlineCorners);
  }
  return kept;
}

}  // namespace

Outline::Outline(std::span<const Vector3d> corners_C_m, double focal_length_px, double centre_x_px, double centre_y_px,
                 int height) {
  Polygon polygon;
  for (const Vector3d& corner : corners_C_m) polygon.corners[polygon.count++] = corner;

  const double side = kGuard_px / focal_length_px;
  MEBOTS_ASSERT(polygon.count >= 3 && focal_length_px > 0);
  const std::array<ClipPlane, 5> planes{{{Vector3d(1.0, 0.0, 0.0), kNearPlane_m},
                                         {Vector3d(side, 1.0, 0.0), 0.0},
                                         {Vector3d(side, -1.0, 0.0), 0.0},
                                         {Vector3d(side, 0.0, 1.0), 0.0},
                                         {Vector3d(side, 0.0, -1.0), 0.0}}};
  for (const ClipPlane& plane : planes) {
    const auto lost = [&](const Vector3d& p) { return plane.distance(p) < 0.0; };
    if (std::none_of(polygon.corners.begin(), polygon.corners.begin() + polygon.count, lost)) continue;
    polygon = clipped(polygon, plane);
    if (polygon.count < 3) return;
  }

  std::array<std::int64_t, kMaxOutlineCorners> x;
  std::array<std::int64_t, kMaxOutlineCorners> y;
  for (int i = 0; i < polygon.count; ++i) {
    const Vector3d& p = polygon.corners[i];
    const double scale = focal_length_px / p.x();
    x[i] = std::llround((centre_x_px - scale * p.y()) * static_cast<double>(kOne));
    y[i] = std::llround((centre_y_px - scale * p.z()) * static_cast<double>(kOne));
  }

  std::int64_t top = INT64_MAX;
  std::int64_t bottom = INT64_MIN;
  for (int i = 0; i < polygon.count; ++i) {
    const int j = (i + 1) % polygon.count;
    top = std::min(top, y[i]);
    bottom = std::max(bottom, y[i]);
    if (y[i] == y[j]) continue;
    // Counter-clockwise in a picture whose y grows downwards: left edges run down, right edges run up.
    const bool down = y[i] < y[j];
    const int a = down ? i : j;
    const int b = down ? j : i;
    edges_[edge_count_++] = Edge{x[a], y[a], y[b], x[b] - x[a], y[b] - y[a], down ? 1 : -1};
  }
  if (edge_count_ == 0) return;
  // The first row whose centre is at or below y.
  const auto row_at = [height](std::int64_t at) {
    const std::int64_t row = (at - kHalf + kOne - 1) >> 12;
    return static_cast<int>(std::clamp<std::int64_t>(row, 0, height));
  };
  static_assert(kOne == 1 << 12);
  first_row_ = row_at(top);
  end_row_ = row_at(bottom);
}

}  // namespace mebots::world::camera
