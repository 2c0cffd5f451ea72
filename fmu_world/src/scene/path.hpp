// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace mebots::world::scene {

/// Where a thing on a path is at a time, seen from where it stands without one, and how fast it goes.
struct Displacement {
  Eigen::Vector3d offset_W_m = Eigen::Vector3d::Zero();
  double turn_rad = 0.0;  ///< about the vertical through the thing's own origin, positive to the left
  Eigen::Vector3d velocity_W_m_per_s = Eigen::Vector3d::Zero();
  double turn_rate_rad_per_s = 0.0;
};

/// How an obstacle moves: at even speed from point to point, a function of time alone, so that it has no state.
/// After the last point it stays there, or begins again when it repeats. Nothing stops it: it has any strength.
struct Path {
  struct Point {
    std::int64_t time_ns = 0;  ///< rising; the first one is 0
    Eigen::Vector3d offset_W_m = Eigen::Vector3d::Zero();
    double turn_rad = 0.0;
  };
  std::vector<Point> points;  ///< none: it stands still; otherwise at least two
  bool repeat = false;

  bool moves() const { return !points.empty(); }
  /// Farthest offset.
  double reach_m() const;
  /// At a time from the start of the run; before it as at it.
  Displacement at(std::int64_t time_ns) const;
};

}  // namespace mebots::world::scene
