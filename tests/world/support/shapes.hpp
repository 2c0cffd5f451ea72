// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.hpp"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>

namespace mebots::world::test {

inline std::shared_ptr<const scene::Mesh> box_mesh(const Eigen::Vector3d& size_m, const scene::Texture& texture) {
  scene::Mesh mesh;
  mesh.materials = {texture};
  for (int i = 0; i < 8; ++i) {  // bit k of the index: on the far side along axis k
    mesh.points_m.emplace_back((((i & 1) != 0 ? 0.5 : -0.5) * size_m.x()), (((i & 2) != 0 ? 0.5 : -0.5) * size_m.y()),
                               (((i & 4) != 0 ? 0.5 : -0.5) * size_m.z()));
  }
  constexpr std::array<std::array<std::uint32_t, 4>, 6> kSides{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& [a, b, c, d] : kSides) {
    mesh.triangles.push_back({{a, b, c}, 0, {}});
    mesh.triangles.push_back({{a, c, d}, 0, {}});
  }
  return std::make_shared<const scene::Mesh>(std::move(mesh));
}

/// Returns a repeating path to an offset and back in four seconds.
inline scene::Path shuttle(const Eigen::Vector3d& offset_m) {
  scene::Path path;
  path.repeat = true;
  path.points = {
      {0, Eigen::Vector3d::Zero(), 0.0}, {2'000'000'000, offset_m, 0.0}, {4'000'000'000, Eigen::Vector3d::Zero(), 0.0}};
  return path;
}

}  // namespace mebots::world::test
