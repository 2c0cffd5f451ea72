// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/lens.hpp"
#include "scene/scene.hpp"

namespace mebots::training {

/// The visible part of a gate's width.
enum class Visibility {
  none,
  sliver,  ///< too small a part, or a view from the side or from behind: no correct answer
  enough
};

struct Advice {
  Visibility visibility = Visibility::none;
  /// Yaw command in [-1, 1], positive = left.
  double yaw = 0.0;
  double distance_m = 0.0;  ///< distance from the camera to the gate's plane; 0 without a gate
  double strength = 0.0;    ///< factor of the command: 1 far from the gate, 0 after fading
  double offset = 0.0;      ///< centre of the opening, to the left of the picture's centre, relative to half the
                            ///< picture's width
};

/// Returns the command of an expert who steers towards the centre of the opening. Yaw is the offset of this centre from
/// the picture's centre, relative to half the picture's width (1 = the left edge), limited to [-1, 1]. Close to the
/// gate, the command fades to 0 while the apparent edge of the frame grows from 1.05 half widths (0.6 m away with a
/// lens of 87 degrees) to 2.1. At 2.1, the frame leaves the picture, and the drone flies straight ahead. If the picture
/// contains no gate, the command is also 0. A gate is a `sliver` if less than a quarter of its width is in the picture,
/// or if the camera sees it from behind or at less than 17 degrees to its plane. A `sliver` has no correct answer.
Advice expert(const world::scene::Scene& scene, const world::camera::Intrinsics& intrinsics,
              const world::camera::Pose& camera);

}  // namespace mebots::training
