// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.hpp"

#include <utility>
#include <vector>

namespace mebots::world {

/// Which command gives which thrust of one rotor, as the stabiliser believes: a bench table, linear
/// between its rows. The true thrust depends on the bus voltage too, which the stabiliser does not know;
/// the altitude integrator makes up for the difference.
class ThrustCurve {
 public:
  /// Rows rise in both columns and begin at (0, 0), as load_scene() makes sure.
  explicit ThrustCurve(std::vector<scene::ThrustPoint> points) : points_(std::move(points)) {}

  double max_thrust_n() const { return points_.back().thrust_n; }
  /// For a thrust from 0 to max_thrust_n().
  double command_for(double thrust_n) const;
  /// The inverse, for a command from 0 to that of max_thrust_n().
  double thrust_for(double command) const;

 private:
  std::vector<scene::ThrustPoint> points_;
};

}  // namespace mebots::world
