// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.hpp"

#include <filesystem>

namespace mebots::world::scene {

/// Reads and checks a scene file (JSON, SI units, angles in rad; fmu_world/docs/scenes.md lists its keys) and the
/// drone file that it names. Throws mebots::Error, which names file, place in the file, value and limit, if a value
/// is missing, misspelt, of the wrong type or outside its limits.
Scene load_scene(const std::filesystem::path& file);

/// Reads and checks a drone file.
Drone load_drone(const std::filesystem::path& file);

}  // namespace mebots::world::scene
