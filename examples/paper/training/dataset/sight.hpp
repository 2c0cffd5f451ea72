// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/lens.hpp"
#include "expert.hpp"
#include "scene/scene.hpp"

namespace mebots::training {

/// Where a picture has the nearest gate that is in it: what the sight network learns to tell.
struct Sight {
  /// enough: in the picture. none: not even a corner of it. sliver: too little, or too flat, to have a right answer;
  /// so is a gate that the camera is about to fly through, whose inner edges are all out of the picture.
  Visibility visibility = Visibility::none;
  /// Middle of the opening from the picture's middle: left over half the width, up over half the height, in [-1, 1].
  double yaw = 0.0;
  double rise = 0.0;
  double size = 0.0;        ///< half the frame's width at the gate's depth over half the picture's width
  double distance_m = 0.0;  ///< from the camera to the gate's plane
  int gate = -1;            ///< which gate of the scene; negative without one
};

Sight sight_of(const world::scene::Scene& scene, const world::camera::Intrinsics& intrinsics,
               const world::camera::Pose& camera);

}  // namespace mebots::training
