// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/lens.hpp"
#include "scene/scene.hpp"

#include <string>

namespace mebots::world {

/// Returns the scene as JSON for drawing (docs/seeing.md describes the format): every face with texture, texture
/// coordinates and light as in the camera; the drone with its rotors and camera; the gates' names; and the names of the
/// variables that move them. SI units, world frame W.
std::string scene_text(const scene::Scene& scene, const camera::Intrinsics& intrinsics,
                       const camera::Mounting& mounting);

}  // namespace mebots::world
