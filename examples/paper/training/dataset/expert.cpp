// SPDX-License-Identifier: Apache-2.0
#include "expert.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::training {
namespace {

using Eigen::Vector3d;

/// The command fades while the apparent edge of the frame grows from the first value to the second, relative to half
/// the picture's width.
constexpr double kFullCommandEdge = 1.05;
constexpr double kNoCommandEdge = 2.1;
constexpr double kLeastVisiblePart = 0.25;
/// The minimum cosine of the angle at which an opening is visible. At a flatter angle, a gate looks like a beam.
constexpr double kLeastCosine = 0.3;
/// The minimum depth along the optical axis. Nearer points are outside of the picture.
constexpr double kLeastDepth_m = 0.05;
constexpr double kBeside = 100.0;

}  // namespace

Advice expert(const world::scene::Scene& scene, const world::camera::Intrinsics& intrinsics,
              const world::camera::Pose& camera) {
  Advice advice;
  if (scene.gates.empty()) return advice;
  const auto& gate = scene.gates[0];
  const Vector3d ahead_W{std::cos(gate.yaw_rad), std::sin(gate.yaw_rad), 0.0};
  const Vector3d left_W{-ahead_W.y(), ahead_W.x(), 0.0};
  const Vector3d to_gate_W = gate.p_W_m - camera.p_WC_m;
  advice.distance_m = ahead_W.dot(to_gate_W);
  const double tangent = std::tan(0.5 * intrinsics.horizontal_field_of_view_rad);
  // Returns the offset of a point to the left of the picture's centre, relative to half the picture's width. For a
  // point that is not in front of the camera, returns an offset far outside of the picture.
  const auto offset_of = [&](const Vector3d& p_W) {
    const Vector3d p_C = camera.R_WC.transpose() * (p_W - camera.p_WC_m);
    return p_C.x() > kLeastDepth_m ? p_C.y() / p_C.x() / tangent : std::copysign(kBeside, p_C.y());
  };
  advice.offset = offset_of(gate.p_W_m);
  const double a = offset_of(gate.p_W_m + 0.5 * gate.outer_m * left_W);
  const double b = offset_of(gate.p_W_m - 0.5 * gate.outer_m * left_W);
  const double low = std::min(a, b);
  const double high = std::max(a, b);
  const double seen = std::min(high, 1.0) - std::max(low, -1.0);
  if (seen <= 0.0) return advice;
  // Close to the gate, the frame may extend beyond the picture on both sides while its centre is ahead.
  const bool through = advice.distance_m > 0.0 && low < -1.0 && high > 1.0 && std::abs(advice.offset) < 1.0;
  const bool flat = advice.distance_m < kLeastCosine * to_gate_W.norm();
  if (!through && (flat || seen < kLeastVisiblePart * (high - low))) {
    advice.visibility = Visibility::sliver;
    return advice;
  }
  advice.visibility = Visibility::enough;
  // Fades the command linearly over the distance, which is proportional to the inverse of the apparent edge.
  const double near = advice.distance_m * tangent / gate.outer_m;
  advice.strength =
      std::clamp((near - 1.0 / kNoCommandEdge) / (1.0 / kFullCommandEdge - 1.0 / kNoCommandEdge), 0.0, 1.0);
  advice.yaw = advice.strength * std::clamp(advice.offset, -1.0, 1.0);
  return advice;
}

}  // namespace mebots::training
