// SPDX-License-Identifier: Apache-2.0
#include "sight.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::training {
namespace {

using Eigen::Vector3d;

/// A gate seen at a flatter angle than this is a beam, not an opening.
constexpr double kFlatCosine = 0.3;
/// Nearer along the optical axis, a point is beside the camera.
constexpr double kBesideDepth_m = 0.05;
/// Of the points along the opening's edge, this part must be in the picture.
constexpr double kLeastInnerPart = 0.15;
constexpr int kPointsPerSide = 10;
/// How far into the beams those points lie, from the inner edge to the outer one.
constexpr double kIntoBeam = 0.2;

/// The part of the points along a frame, upright in the gate's plane, that `sees` is true of: `part` of the way from
/// the opening's edge to the frame's. A circle and a polygon count as a circle.
template <typename Sees>
double visible_part(const world::scene::Gate& gate, const Vector3d& left_W, double part, const Sees& sees) {
  const double across_m = 0.5 * std::lerp(gate.inner_m, gate.outer_m, part);
  const double up_m = 0.5 * std::lerp(gate.opening_height_m(), gate.frame_height_m(), part);
  const auto seen = [&](double left, double up) {
    return sees(Vector3d(gate.p_W_m + left * left_W + up * Vector3d::UnitZ())) ? 1 : 0;
  };
  int count = 0;
  for (int i = 0; i < kPointsPerSide; ++i) {
    const double along = 2.0 * (i + 0.5) / kPointsPerSide - 1.0;
    for (const double side : {-1.0, 1.0}) {
      if (gate.has_beams()) {
        count += seen(side * across_m, along * up_m) + seen(along * across_m, side * up_m);
      } else {
        const double angle = 0.5 * M_PI * along;
        count += seen(side * across_m * std::cos(angle), up_m * std::sin(angle));
        count += seen(across_m * std::sin(angle), side * up_m * std::cos(angle));
      }
    }
  }
  return count / (4.0 * kPointsPerSide);
}

Sight sight_of_gate(const world::scene::Gate& gate, const world::camera::Intrinsics& intrinsics,
                    const world::camera::Pose& camera) {
  Sight sight;
  const Vector3d ahead_W{std::cos(gate.yaw_rad), std::sin(gate.yaw_rad), 0.0};
  const Vector3d left_W{-ahead_W.y(), ahead_W.x(), 0.0};
  const Vector3d to_gate_W = gate.p_W_m - camera.p_WC_m;
  sight.distance_m = ahead_W.dot(to_gate_W);
  const double across = std::tan(0.5 * intrinsics.horizontal_field_of_view_rad);
  const double upright = across * intrinsics.height / intrinsics.width;
  const auto in_camera = [&](const Vector3d& p_W) { return Vector3d(camera.R_WC.transpose() * (p_W - camera.p_WC_m)); };
  const auto in_picture = [&](const Vector3d& p_W) {
    const Vector3d p = in_camera(p_W);
    return p.x() > kBesideDepth_m && std::abs(p.y()) < across * p.x() && std::abs(p.z()) < upright * p.x();
  };
  const double inner = visible_part(gate, left_W, kIntoBeam, in_picture);
  const double outer = visible_part(gate, left_W, 1.0, in_picture);
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
