// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace mebots::world::camera {

/// Corners nearer to the camera's plane are cut away.
inline constexpr double kNearPlane_m = 1e-3;
/// Planes that cut a face off; each can add a corner.
inline constexpr std::size_t kClipPlanes = 5;
/// A face has at most 8 corners; each of the five clip planes can add one. The rest is reserve.
inline constexpr std::size_t kMaxOutlineCorners = 16;

/// Which pixels a convex polygon covers: those whose centre is inside. Corners are snapped to 1/4096 of a
/// pixel and everything after that is integer arithmetic, so the answer is exact. A centre on an edge belongs to the
/// polygon if the edge is a left or top one; polygons that share an edge thus never share or miss a pixel.
class Outline {
 public:
  /// The camera's optical axis meets the picture's middle.
  struct Picture {
    double focal_length_px;
    int width, height;
  };
  static constexpr std::int64_t kOne = 4096;  // a pixel
  static constexpr std::int64_t kHalf = kOne / 2;

  struct Edge {
    std::int32_t x_top, y_top, y_bottom;  // in 1/4096 pixel
    std::int32_t dx, dy;                  // from top to bottom, dy > 0
    std::int32_t winding;                 // 1 where the polygon begins to its right, -1 where it ends
    double columns_per_unit;              // 1 / (4096 dy), rounded

    /// First column whose centre is on or right of the edge at height y, cut to [0, width].
    int first_column(std::int64_t y, int width) const {
      // (kOne column + kHalf - x_top) dy >= dx (y - y_top). At most 2^30 times 2^31, so it fits.
      const std::int64_t numerator = (x_top - kHalf) * dy + dx * (y - y_top);
      if (numerator <= 0) return 0;
      const std::int64_t denominator = dy * kOne;
      if (numerator > width * denominator) return width;
      // The quotient in floating point is off by less than 1e-12, so that its whole part is the one looked for or the
      // one before. A division of integers would take most of the time of a picture with many small faces.
      auto column = static_cast<std::int64_t>(static_cast<double>(numerator) * columns_per_unit);
      while (column * denominator < numerator) ++column;
      return static_cast<int>(column);
    }
  };
  using Edges = std::span<Edge, kMaxOutlineCorners>;

  /// `corners_C_m` in the camera frame, counter-clockwise seen from the camera. Its edges are the first edge_count() of
  /// `edges`, which must stay where they are. Needs no heap.
  Outline(const Picture& picture, std::span<const Eigen::Vector3d> corners_C_m, Edges edges);

  /// Rows that it covers: [first_row, end_row), empty if no pixel's centre is between its outermost corners.
  int first_row() const { return first_row_; }
  int end_row() const { return end_row_; }
  int edge_count() const { return edge_count_; }

  /// Calls span(begin, end) for each run of covered columns in a row, cut to the picture.
  template <typename Span>
  void spans(int row, Span&& span) const {
    // Crossings of the row's centre line, from left to right. A convex polygon has two; snapping can dent
    // one by 1/4096 pixel, hence the general winding count.
    std::array<Crossing, kMaxOutlineCorners> crossings;
    int count = 0;
    const std::int64_t y = row * kOne + kHalf;
    for (int i = 0; i < edge_count_; ++i) {
      const Edge& edge = edges_[i];
      if (y < edge.y_top || y >= edge.y_bottom) continue;
      const Crossing crossing{edge.first_column(y, width_), edge.winding};
      int place = count++;
      for (; place > 0 && crossings[place - 1].column > crossing.column; --place)
        crossings[place] = crossings[place - 1];
      crossings[place] = crossing;
    }
    int winding = 0;
    for (int i = 0; i + 1 < count; ++i) {
      winding += crossings[i].winding;
      if (winding > 0 && crossings[i].column < crossings[i + 1].column) {
        span(crossings[i].column, crossings[i + 1].column);
      }
    }
  }

 private:
  struct Crossing {
    int column, winding;
  };

  const Edge* edges_;
  int edge_count_ = 0;
  int width_;
  int first_row_ = 0;
  int end_row_ = 0;
};

}  // namespace mebots::world::camera
