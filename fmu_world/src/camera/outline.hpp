// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/assert.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace mebots::world::camera {

/// Parts of a face with a smaller depth along the camera's optical axis are cut off.
inline constexpr double kNearPlane_m = 1e-3;
/// The number of planes that cut a face. Each plane can add a corner.
inline constexpr std::size_t kClipPlanes = 5;
/// A face has at most 8 corners, and each of the five planes can add one. The remaining three are a reserve.
inline constexpr std::size_t kMaxOutlineCorners = 16;

/// Determines the pixels of a convex polygon: the pixels whose centres are inside. Rounds the corners to 1/4096 pixel.
/// All further computations use integers, so they are exact. A centre on an edge belongs to the polygon if the edge is
/// a left edge or a top edge. Therefore polygons with a common edge neither share nor miss a pixel.
class Outline {
 public:
  /// The camera's optical axis passes through the middle of the picture.
  struct Picture {
    double focal_length_px;
    int width, height;
  };
  static constexpr std::int64_t kOne = 4096;  // a pixel
  static constexpr std::int64_t kHalf = kOne / 2;

  /// An edge of an outline. It crosses the centre line of at least one row.
  struct Edge {
    std::int32_t x_top, y_top;  // in 1/4096 pixel
    std::int32_t dx, dy;        // from top to bottom, dy > 0
    int first_row, end_row;     // rows whose centres it passes, within the picture
    std::int32_t winding;       // 1 if the polygon is to its right, -1 if to its left
    double columns_per_unit;    // 1 / (4096 dy), rounded

    /// Computes the first column whose centre is on or right of the edge, for each of the rows [first, end). The edge
    /// must cross the centre lines of these rows.
    void columns(int first, int end, std::int32_t* columns) const {
      // The result is the least column with (kOne column + kHalf - x_top) dy >= dx (y - y_top), a quotient that is
      // rounded up. The product is at most 2^30 times 2^31, so it fits into 64 bits.
      const std::int64_t y = first * kOne + kHalf;
      const std::int64_t numerator = (x_top - kHalf) * dy + dx * (y - y_top);
      const std::int64_t denominator = dy * kOne;
      // The floating-point quotient has an error below 1e-10, so its integer part differs by at most one from the exact
      // result. Integer divisions would take most of the rendering time of a picture with many small faces.
      auto column = static_cast<std::int64_t>(static_cast<double>(numerator) * columns_per_unit);
      std::int64_t beyond = column * denominator - numerator;  // in [0, denominator) for the exact column
      const int off = static_cast<int>(beyond < 0) - static_cast<int>(beyond >= denominator);
      column += off;
      beyond += off * denominator;
      // From one row to the next, numerator / denominator changes by dx / dy. `whole` is this change, rounded down. The
      // remainder `rest` is subtracted from `beyond`.
      const std::int32_t whole = dx / dy - static_cast<int>(dx % dy < 0);
      const std::int64_t rest = (dx - static_cast<std::int64_t>(whole) * dy) * kOne;
      for (int row = first; row < end; ++row) {
        *columns++ = static_cast<std::int32_t>(column);
        beyond -= rest;
        const bool next = beyond < 0;
        column += whole + static_cast<int>(next);
        beyond += next ? denominator : 0;
      }
    }
  };
  using Edges = std::span<Edge, kMaxOutlineCorners>;

  /// `corners_C_m` are in the camera frame, counter-clockwise seen from the camera. The outline stores its edges in the
  /// first edge_count() elements of `edges`. `edges` must outlive the outline and must not move. Uses no heap.
  Outline(const Picture& picture, std::span<const Eigen::Vector3d> corners_C_m, Edges edges);

  /// The polygon covers pixels only in the rows [first_row, end_row). The range is empty if the polygon contains no
  /// pixel's centre.
  int first_row() const { return first_row_; }
  int end_row() const { return end_row_; }
  int edge_count() const { return edge_count_; }

  /// The greatest number of rows in one call of spans().
  static constexpr int kStripRows = 16;

  /// Calls span(row, begin, end) for each run of covered columns in the rows [first, end), within the picture.
  template <typename Span>
  void spans(int first, int end, Span&& span) const {
    first = std::max(first, first_row_);
    end = std::min(end, end_row_);
    if (!two_crossings_) {
      for (int row = first; row < end; ++row) winding_spans(row, span);
      return;
    }
    MEBOTS_ASSERT(end - first <= kStripRows);
    std::array<std::int32_t, kStripRows> begins;
    std::array<std::int32_t, kStripRows> ends;
    for (int i = 0; i < edge_count_; ++i) {
      const Edge& edge = edges_[i];
      const int from = std::max(first, edge.first_row);
      const int to = std::min(end, edge.end_row);
      if (from < to) edge.columns(from, to, (edge.winding > 0 ? begins : ends).data() + (from - first));
    }
    for (int row = first; row < end; ++row) {
      const int from = std::max(begins[row - first], 0);
      const int to = std::min(ends[row - first], width_);
      if (from < to) span(row, from, to);
    }
  }

 private:
  struct Crossing {
    int column, winding;
  };

  /// Works as spans() for one row, but the row's centre line may cross any number of edges.
  template <typename Span>
  void winding_spans(int row, Span&& span) const {
    std::array<Crossing, kMaxOutlineCorners> crossings;  // of the row's centre line, from left to right
    int count = 0;
    for (int i = 0; i < edge_count_; ++i) {
      const Edge& edge = edges_[i];
      if (row < edge.first_row || row >= edge.end_row) continue;
      std::int32_t column = 0;
      edge.columns(row, row + 1, &column);
      int place = count++;
      for (; place > 0 && crossings[place - 1].column > column; --place) crossings[place] = crossings[place - 1];
      crossings[place] = {std::clamp(column, 0, width_), edge.winding};
    }
    int winding = 0;
    for (int i = 0; i + 1 < count; ++i) {
      winding += crossings[i].winding;
      if (winding > 0 && crossings[i].column < crossings[i + 1].column)
        span(row, crossings[i].column, crossings[i + 1].column);
    }
  }

  const Edge* edges_;
  int edge_count_ = 0;
  int width_;
  int first_row_ = 0;
  int end_row_ = 0;
  /// True if each row's centre line crosses two edges, as for a convex polygon. Rounding to 1/4096 pixel can make a
  /// polygon slightly concave.
  bool two_crossings_ = true;
};

}  // namespace mebots::world::camera
