// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.hpp"

#include <filesystem>

namespace mebots::world::scene {

/// Reads and checks a scene file (JSON, SI units, angles in rad; fmu_world/README.md tells its keys) and the
/// drone file that it names. Throws mebots::Error naming file, place in the file, value and limit for anything
/// that is missing, misspelt, of the wrong type or outside its limits.
Scene load_scene(const std::filesystem::path& file);

/// Reads and checks a drone file.
Drone load_drone(const std::filesystem::path& file);

}  // namespace mebots::world::scene
