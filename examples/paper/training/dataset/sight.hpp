// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/lens.hpp"
#include "expert.hpp"
#include "scene/scene.hpp"

namespace mebots::training {

/// Contains the position of the nearest gate in a picture, which the sight network learns.
struct Sight {
  /// enough: the gate is in the picture. none: not even a corner of the gate is in the picture. sliver: the visible
  /// part is too small or too flat for a correct answer. A gate that the camera is about to fly through is also a
  /// sliver, if the inner edges are all outside of the picture.
  Visibility visibility = Visibility::none;
  /// Centre of the opening relative to the picture's centre, in [-1, 1]. yaw: distance to the left, divided by half the
  /// picture's width. rise: distance upwards, divided by half its height.
  double yaw = 0.0;
  double rise = 0.0;
  double size = 0.0;        ///< half the frame's width at the gate's depth, relative to half the picture's width
  double distance_m = 0.0;  ///< distance from the camera to the gate's plane
  int gate = -1;            ///< index of the gate in the scene; negative if there is none
};

Sight sight_of(const world::scene::Scene& scene, const world::camera::Intrinsics& intrinsics,
               const world::camera::Pose& camera);

}  // namespace mebots::training
