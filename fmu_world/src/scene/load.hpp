// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/mesh.hpp"
#include "scene/scene.hpp"

#include <filesystem>

namespace mebots::world::scene {

/// Reads a scene file (JSON, SI units, angles in rad; fmu_world/docs/scenes.md lists its keys), and the drone file that
/// it names. Throws a mebots::Error if a key is missing or unknown, or if a value has the wrong type or is out of
/// range. The error contains file, place in the file, value and limit.
Scene load_scene(const std::filesystem::path& file);

/// Throws the same errors as load_scene().
Drone load_drone(const std::filesystem::path& file);

/// Reads the triangles of a glTF 2.0 file (.gltf or .glb): all nodes of its default scene, with the base colours of
/// their materials as grey levels. Converts glTF's axes (y up, z forward) to the world's axes (z up, x forward), and
/// multiplies lengths by `scale`. Textures are PNG pictures inside the file or next to it. Throws mebots::Error that
/// begins with the file's name if the file is damaged or not a glTF, has primitives other than triangles, requires
/// extensions, or has more than kMostTriangles triangles.
Mesh read_gltf(const std::filesystem::path& file, double scale);

}  // namespace mebots::world::scene
