// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/mesh.hpp"
#include "scene/scene.hpp"

#include <filesystem>

namespace mebots::world::scene {

/// Reads and checks a scene file (JSON, SI units, angles in rad; fmu_world/docs/scenes.md lists its keys), and the
/// drone file whose name it contains. Throws a mebots::Error if a key is missing or unknown, or if a value has the
/// wrong type or is out of range. The error names file, place in the file, value and limit.
Scene load_scene(const std::filesystem::path& file);

/// Reads and checks a drone file. Throws the same errors as load_scene().
Drone load_drone(const std::filesystem::path& file);

/// Reads the triangles of a glTF 2.0 file (.gltf or .glb): all nodes of its default scene, with the base colours of
/// their materials as grey levels. glTF's axes (y up, z forward) become those of the world (z up, x forward); lengths
/// are multiplied by `scale`. Textures are PNG pictures inside the file or next to it. Throws mebots::Error that begins
/// with the file's name if the file is not a glTF or is damaged, for primitives other than triangles, for required
/// extensions, and for more than kMostTriangles.
Mesh read_gltf(const std::filesystem::path& file, double scale);

}  // namespace mebots::world::scene
