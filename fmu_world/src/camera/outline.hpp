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

  /// One that passes the centre of a row at least.
  struct Edge {
    std::int32_t x_top, y_top;  // in 1/4096 pixel
    std::int32_t dx, dy;        // from top to bottom, dy > 0
    int first_row, end_row;     // whose centres it passes, cut to the picture
    std::int32_t winding;       // 1 where the polygon begins to its right, -1 where it ends
    double columns_per_unit;    // 1 / (4096 dy), rounded

    /// For each of the rows [first, end), which it must pass: the first column whose centre is on or right of the edge.
    void columns(int first, int end, std::int32_t* columns) const {
      // That is the least column with (kOne column + kHalf - x_top) dy >= dx (y - y_top), so a quotient rounded up.
      // At most 2^30 times 2^31, so it fits.
      const std::int64_t y = first * kOne + kHalf;
      const std::int64_t numerator = (x_top - kHalf) * dy + dx * (y - y_top);
      const std::int64_t denominator = dy * kOne;
      // In floating point it is off by less than 1e-10, and its whole part by at most one. A division of integers would
      // take most of the time of a picture with many small faces.
      auto column = static_cast<std::int64_t>(static_cast<double>(numerator) * columns_per_unit);
      std::int64_t beyond = column * denominator - numerator;  // is in [0, denominator) of the right one
      const int off = static_cast<int>(beyond < 0) - static_cast<int>(beyond >= denominator);
      column += off;
      beyond += off * denominator;
      // From row to row the quotient grows by dx / dy: by whole columns and a rest that is taken from what it is
      // beyond.
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

  /// `corners_C_m` in the camera frame, counter-clockwise seen from the camera. Its edges are the first edge_count() of
  /// `edges`, which must stay where they are. Needs no heap.
  Outline(const Picture& picture, std::span<const Eigen::Vector3d> corners_C_m, Edges edges);

  /// Rows that it covers: [first_row, end_row), empty if no pixel's centre is between its outermost corners.
  int first_row() const { return first_row_; }
  int end_row() const { return end_row_; }
  int edge_count() const { return edge_count_; }

  /// Rows that spans() takes at once, at most.
  static constexpr int kStripRows = 16;

  /// Calls span(row, begin, end) for each run of covered columns in the rows [first, end), cut to the picture.
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

  /// The same for one row that has any number of crossings.
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
  /// Each row's centre line is crossed twice, as a convex polygon's. Snapping can dent one by 1/4096 pixel.
  bool two_crossings_ = true;
};

}  // namespace mebots::world::camera
