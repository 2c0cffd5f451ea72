// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/lens.hpp"
#include "scene/scene.hpp"

namespace mebots::training {

/// How much of a gate is in the picture, across.
enum class Visibility {
  none,
  sliver,  ///< too little of it, or seen from the side or from behind: no right answer
  enough
};

/// What the expert says to a picture.
struct Advice {
  Visibility visibility = Visibility::none;
  /// Yaw command in [-1, 1], positive = left.
  double yaw = 0.0;
  double distance_m = 0.0;  ///< from the camera to the gate's plane; 0 without a gate
  double strength = 0.0;    ///< 1 far from the gate, 0 where the command has faded
  double offset = 0.0;      ///< middle of the opening, left of the picture's middle, over half the picture's width
};

/// The expert steers at the middle of the opening: yaw = its offset from the picture's middle over half the
/// picture's width, 1 = the left edge, limited to [-1, 1]. Near the gate the command fades,
/// from where the frame's edge looks 1.05 half widths long (0.6 m away with a lens of 87 degrees) and is 0 from 2.1 on.
/// The frame leaves the picture there, and the drone flies straight on. Without a gate in the
/// picture the command is 0 too. A gate of which less than a quarter is in the picture, across, or that is seen at
/// less than 17 degrees to its plane or from behind, is a `sliver`, which has no right answer.
Advice expert(const world::scene::Scene& scene, const world::camera::Intrinsics& intrinsics,
              const world::camera::Pose& camera);

}  // namespace mebots::training
