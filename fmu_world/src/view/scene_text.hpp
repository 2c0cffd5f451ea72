// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/lens.hpp"
#include "scene/scene.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace mebots::world {

/// The data that a drawing of a drone needs.
struct ViewedDrone {
  scene::Drone drone;
  camera::Intrinsics intrinsics;
  camera::Mounting mounting;
  std::string name;  ///< "drone[2]", the beginning of its variables' names; empty for the drone of an FMU of one
};

/// Returns the scene as JSON for drawing (docs/seeing.md describes the format). The JSON contains every face with
/// texture, texture coordinates and light as in the camera, and the drones with rotors and camera. It also contains the
/// names of the gates, and of the variables that move drones and robots. SI units, world frame W.
std::string scene_text(const scene::Scene& scene, const std::vector<ViewedDrone>& drones, std::size_t robots);

}  // namespace mebots::world
