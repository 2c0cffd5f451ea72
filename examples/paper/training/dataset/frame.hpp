// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.hpp"

#include <cmath>

namespace mebots::training {

/// Returns the share of points along a gate's frame for which `is` returns true. The points are in the gate's plane,
/// between the opening's edge (`into` = 0) and the frame's edge (`into` = 1). A polygonal frame is treated as a circle.
template <typename Is>
double part_of_frame(const world::scene::Gate& gate, double into, const Is& is) {
  constexpr int kPointsPerSide = 10;
  const Eigen::Vector3d left_W{-std::sin(gate.yaw_rad), std::cos(gate.yaw_rad), 0.0};
  const double across_m = 0.5 * std::lerp(gate.inner_m, gate.outer_m, into);
  const double up_m = 0.5 * std::lerp(gate.opening_height_m(), gate.frame_height_m(), into);
  const auto one_if = [&](double left, double up) {
    return is(Eigen::Vector3d(gate.p_W_m + left * left_W + up * Eigen::Vector3d::UnitZ())) ? 1 : 0;
  };
  int count = 0;
  for (int i = 0; i < kPointsPerSide; ++i) {
    const double along = 2.0 * (i + 0.5) / kPointsPerSide - 1.0;
    for (const double side : {-1.0, 1.0}) {
      if (gate.has_beams()) {
        count += one_if(side * across_m, along * up_m) + one_if(along * across_m, side * up_m);
      } else {
        const double angle = 0.5 * M_PI * along;
        count += one_if(side * across_m * std::cos(angle), up_m * std::sin(angle));
        count += one_if(across_m * std::sin(angle), side * up_m * std::cos(angle));
      }
    }
  }
  return count / (4.0 * kPointsPerSide);
}

}  // namespace mebots::training
