// SPDX-License-Identifier: Apache-2.0
#include "camera/outline.hpp"

#include "mebots/assert.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::world::camera {
namespace {

using Eigen::Vector3d;

/// Guard band: parts of a face that are farther from the middle of the picture are cut off, so that integers stay
/// small.
constexpr double kGuard_px = 32768.0;

struct Polygon {
  std::array<Vector3d, kMaxOutlineCorners> corners;
  int count = 0;
};

/// Keeps corners with a positive distance to the plane.
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
    // Always computes the point from the kept corner to the lost corner. Two polygons go along a common edge in
    // opposite directions, and must get the same bits.
    if (da >= 0.0 && db < 0.0) kept.corners[kept.count++] = a + (da / (da - db)) * (b - a);
    if (da < 0.0 && db >= 0.0) kept.corners[kept.count++] = b + (db / (db - da)) * (a - b);
    if (kept.count > static_cast<int>(kMaxOutlineCorners) - 2) break;  // impossible for a convex polygon
    MEBOTS_ASSERT(kept.count < static_cast<int>(kMaxOutlineCorners));
  }
  return kept;
}

/// Returns true if no plane cuts the face, as for nearly all faces. This test takes less time than clipping by the
/// planes.
bool all_inside(std::span<const Vector3d> corners_C_m, double side) {
  bool inside = true;
  for (const Vector3d& p : corners_C_m) {
    const double limit = side * p.x();
    inside = inside && p.x() >= kNearPlane_m && std::abs(p.y()) <= limit && std::abs(p.z()) <= limit;
  }
  return inside;
}

Polygon clipped(std::span<const Vector3d> corners_C_m, double side) {
  Polygon polygon;
  for (const Vector3d& corner : corners_C_m) polygon.corners[static_cast<std::size_t>(polygon.count++)] = corner;
  const std::array<ClipPlane, kClipPlanes> planes{{{Vector3d(1.0, 0.0, 0.0), kNearPlane_m},
                                                   {Vector3d(side, 1.0, 0.0), 0.0},
                                                   {Vector3d(side, -1.0, 0.0), 0.0},
                                                   {Vector3d(side, 0.0, 1.0), 0.0},
                                                   {Vector3d(side, 0.0, -1.0), 0.0}}};
  for (const ClipPlane& plane : planes) {
    bool lost = false;
    for (int i = 0; i < polygon.count; ++i) lost = lost || plane.distance(polygon.corners[i]) < 0.0;
    if (lost) polygon = clipped(polygon, plane);
    if (polygon.count < 3) break;
  }
  return polygon;
}

/// Rounds to the nearest integer, halves away from 0. Works as std::llround() without a call.
std::int32_t to_nearest(double value) {
  const auto whole = static_cast<std::int32_t>(value);
  const double rest = value - whole;  // exact
  return whole + static_cast<std::int32_t>(rest >= 0.5) - static_cast<std::int32_t>(rest <= -0.5);
}

}  // namespace

Outline::Outline(const Picture& picture, std::span<const Vector3d> corners_C_m, Edges edges)
    : edges_(edges.data()), width_(picture.width) {
  const auto [focal_length_px, width, height] = picture;
  const double side = kGuard_px / focal_length_px;
  MEBOTS_ASSERT(corners_C_m.size() >= 3 && focal_length_px > 0);
  Polygon polygon;
  if (!all_inside(corners_C_m, side)) {
    polygon = clipped(corners_C_m, side);
    if (polygon.count < 3) return;
    corners_C_m = {polygon.corners.data(), static_cast<std::size_t>(polygon.count)};
  }
  const int corners = static_cast<int>(corners_C_m.size());

  // Within the guard band, values and their differences are below 2^28, so they fit into 32 bits.
  std::array<std::int32_t, kMaxOutlineCorners> x;
  std::array<std::int32_t, kMaxOutlineCorners> y;
  for (int i = 0; i < corners; ++i) {
    const Vector3d& p = corners_C_m[static_cast<std::size_t>(i)];
    const double scale = focal_length_px / p.x();
    x[i] = to_nearest((0.5 * width - scale * p.y()) * static_cast<double>(kOne));
    y[i] = to_nearest((0.5 * height - scale * p.z()) * static_cast<double>(kOne));
  }

  const auto [left, right] = std::minmax_element(x.begin(), x.begin() + corners);
  const auto [top, bottom] = std::minmax_element(y.begin(), y.begin() + corners);
  // Returns the first row whose centre is not above the coordinate `at`, or the first column whose centre is not left
  // of it.
  const auto first_at = [](std::int32_t at, int count) {
    static_assert(kOne == 1 << 12);
    return static_cast<int>(std::clamp<std::int64_t>((at - kHalf + kOne - 1) >> 12, 0, count));
  };
  if (first_at(*left, width) == first_at(*right, width)) return;
  first_row_ = first_at(*top, height);
  end_row_ = first_at(*bottom, height);
  if (first_row_ == end_row_) return;
  int begun_rows = 0;
  for (int i = 0; i < corners; ++i) {
    const int j = i + 1 < corners ? i + 1 : 0;
    // The polygon is counter-clockwise, and y grows downwards, so left edges go down and right edges go up.
    const bool down = y[i] < y[j];
    const int a = down ? i : j;
    const int b = down ? j : i;
    const int first = first_at(y[a], height);
    const int end = first_at(y[b], height);
    if (first == end) continue;
    const std::int32_t dy = y[b] - y[a];
    edges[static_cast<std::size_t>(edge_count_++)] = {
        x[a],  y[a], x[b] - x[a],   dy,
        first, end,  down ? 1 : -1, 1.0 / (static_cast<double>(dy) * static_cast<double>(kOne))};
    if (down) begun_rows += end - first;
  }
  // A closed outline crosses each row as often downwards as upwards. With one downward edge per row, each row has two
  // crossings.
  two_crossings_ = begun_rows == end_row_ - first_row_;
}

}  // namespace mebots::world::camera
