// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace mebots::world::camera {

/// Corners nearer to the camera's plane are cut away.
inline constexpr double kNearPlane_m = 1e-3;
/// A face has at most 8 corners; each of the five clip planes can add one. The rest is reserve.
inline constexpr int kMaxOutlineCorners = 16;

/// Which pixels a convex polygon covers: those whose centre is inside. Corners are snapped to 1/4096 of a
/// pixel and everything after that is integer arithmetic, so the answer is exact. A centre on an edge belongs to the
/// polygon if the edge is a left or top one; polygons that share an edge thus never share or miss a pixel.
class Outline {
 public:
  /// `corners_C_m` in the camera frame, counter-clockwise seen from the camera. `centre_*_px` is where the
  /// optical axis meets the picture. Needs no heap.
  Outline(std::span<const Eigen::Vector3d> corners_C_m, double focal_length_px, double centre_x_px, double centre_y_px,
          int height);
  Outline() = default;

  /// Rows that it covers: [first_row, end_row), empty if the polygon is out of the picture's rows.
  int first_row() const { return first_row_; }
  int end_row() const { return end_row_; }

  /// Calls span(begin, end) for each run of covered columns in a row, cut to [0, width).
  template <typename Span>
  void spans(int row, int width, Span&& span) const {
    // Crossings of the row's centre line, from left to right. A convex polygon has two; snapping can dent
    // one by 1/4096 pixel, hence the general winding count.
    std::array<std::pair<int, int>, kMaxOutlineCorners> crossings;
    int count = 0;
    const std::int64_t y = row * kOne + kHalf;
    for (int i = 0; i < edge_count_; ++i) {
      const Edge& edge = edges_[i];
      if (y < edge.y_top || y >= edge.y_bottom) continue;
      std::pair<int, int> crossing{edge.first_column(y, width), edge.winding};
      int place = count++;
      for (; place > 0 && crossings[place - 1].first > crossing.first; --place) crossings[place] = crossings[place - 1];
      crossings[place] = crossing;
    }
    int winding = 0;
    for (int i = 0; i + 1 < count; ++i) {
      winding += crossings[i].second;
      if (winding > 0 && crossings[i].first < crossings[i + 1].first) {
        span(crossings[i].first, crossings[i + 1].first);
      }
    }
  }

 private:
  static constexpr std::int64_t kOne = 4096;  // a pixel
  static constexpr std::int64_t kHalf = kOne / 2;

  struct Edge {
    std::int64_t x_top, y_top, y_bottom;  // in 1/4096 pixel
    std::int64_t dx, dy;                  // from top to bottom, dy > 0
    int winding;                          // 1 where the polygon begins to its right, -1 where it ends

    /// First column whose centre is on or right of the edge at height y, cut to [0, width].
    int first_column(std::int64_t y, int width) const {
      // (kOne column + kHalf - x_top) dy >= dx (y - y_top). At most 2^30 times 2^31, so it fits.
      const std::int64_t numerator = (x_top - kHalf) * dy + dx * (y - y_top);
      if (numerator <= 0) return 0;
      const std::int64_t denominator = dy * kOne;
      return static_cast<int>(std::min<std::int64_t>((numerator + denominator - 1) / denominator, width));
    }
  };

  std::array<Edge, kMaxOutlineCorners> edges_;
  int edge_count_ = 0;
  int first_row_ = 0;
  int end_row_ = 0;
};

}  // namespace mebots::world::camera
