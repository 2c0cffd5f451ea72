// SPDX-License-Identifier: Apache-2.0
#include "sight.hpp"

#include "frame.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::training {
namespace {

using Eigen::Vector3d;

/// The minimum cosine of the angle at which an opening is visible. At a flatter angle, a gate looks like a beam.
constexpr double kFlatCosine = 0.3;
/// The minimum depth along the optical axis. Nearer points are outside of the picture.
constexpr double kBesideDepth_m = 0.05;
/// The minimum share of points along the opening's edge that must be in the picture.
constexpr double kLeastInnerPart = 0.15;
/// The points that must be in the picture are at this share of the way from the frame's inner edge to its outer edge.
constexpr double kIntoBeam = 0.2;

Sight sight_of_gate(const world::scene::Gate& gate, const world::camera::Intrinsics& intrinsics,
                    const world::camera::Pose& camera) {
  Sight sight;
  const Vector3d ahead_W{std::cos(gate.yaw_rad), std::sin(gate.yaw_rad), 0.0};
  const Vector3d to_gate_W = gate.p_W_m - camera.p_WC_m;
  sight.distance_m = ahead_W.dot(to_gate_W);
  const double across = std::tan(0.5 * intrinsics.horizontal_field_of_view_rad);
  const double upright = across * intrinsics.height / intrinsics.width;
  const auto in_camera = [&](const Vector3d& p_W) { return Vector3d(camera.R_WC.transpose() * (p_W - camera.p_WC_m)); };
  const auto in_picture = [&](const Vector3d& p_W) {
    const Vector3d p = in_camera(p_W);
    return p.x() > kBesideDepth_m && std::abs(p.y()) < across * p.x() && std::abs(p.z()) < upright * p.x();
  };
  const double inner = part_of_frame(gate, kIntoBeam, in_picture);
  const double outer = part_of_frame(gate, 1.0, in_picture);
  const Vector3d middle = in_camera(gate.p_W_m);
  if (inner == 0.0 && outer == 0.0 && !in_picture(gate.p_W_m)) return sight;
  sight.visibility = Visibility::sliver;
  const bool flat = sight.distance_m < kFlatCosine * to_gate_W.norm();
  if (flat || middle.x() <= kBesideDepth_m || inner < kLeastInnerPart) return sight;
  sight.visibility = Visibility::enough;
  sight.yaw = std::clamp(middle.y() / middle.x() / across, -1.0, 1.0);
  sight.rise = std::clamp(middle.z() / middle.x() / upright, -1.0, 1.0);
  sight.size = 0.5 * gate.outer_m / (middle.x() * across);
  return sight;
}

}  // namespace

Sight sight_of(const world::scene::Scene& scene, const world::camera::Intrinsics& intrinsics,
               const world::camera::Pose& camera) {
  Sight nearest;
  double nearest_m = 0.0;
  for (int i = 0; const auto& gate : scene.gates) {
    const double away_m = (gate.p_W_m - camera.p_WC_m).norm();
    Sight sight = sight_of_gate(gate, intrinsics, camera);
    sight.gate = i++;
    if (sight.visibility == Visibility::none) continue;
    if (nearest.gate >= 0 && away_m >= nearest_m) continue;
    nearest = sight;
    nearest_m = away_m;
  }
  return nearest;
}

}  // namespace mebots::training
