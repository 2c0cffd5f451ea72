// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/lens.hpp"
#include "expert.hpp"
#include "scene/scene.hpp"

namespace mebots::training {

/// The position of the nearest gate in a picture. The sight network learns this.
struct Sight {
  /// enough: the gate is in the picture. none: not even a corner of the gate is in the picture. sliver: the visible
  /// part is too small or too flat for a correct answer. If the camera is close to the gate and all inner edges are
  /// outside of the picture, the gate is also a sliver.
  Visibility visibility = Visibility::none;
  /// The centre of the opening relative to the picture's centre, in [-1, 1]. yaw: distance to the left, divided by half
  /// the picture's width. rise: distance upwards, divided by half the picture's height.
  double yaw = 0.0;
  double rise = 0.0;
  double size = 0.0;        ///< half the frame's width at the gate's depth, relative to half the picture's width
  double distance_m = 0.0;  ///< distance from the camera to the gate's plane
  int gate = -1;            ///< index of the gate in the scene; negative if there is none
};

Sight sight_of(const world::scene::Scene& scene, const world::camera::Intrinsics& intrinsics,
               const world::camera::Pose& camera);

}  // namespace mebots::training
