// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/texture.hpp"

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace mebots::world::scene {

/// A surface of triangles in a frame of its own (x forward, y left, z up, metres).
struct Mesh {
  struct Triangle {
    std::array<std::uint32_t, 3> corners{};  ///< indices of `points_m`, counter-clockwise seen from outside
    std::uint32_t material = 0;              ///< index of `materials`
    /// Texture coordinates of the corners in tiles, u to the right and v up. None: the texture lies on the surface in
    /// metres, along the two axes of the mesh that its normal is farthest from.
    std::optional<std::array<Eigen::Vector2d, 3>> tiles;
  };

  std::vector<Eigen::Vector3d> points_m;
  std::vector<Triangle> triangles;
  std::vector<Texture> materials;

  /// Unit normal of a triangle, in the mesh's frame; zero for one without an area.
  Eigen::Vector3d normal(const Triangle& triangle) const;
  /// Farthest point from the origin.
  double radius_m() const;
};

/// More triangles than a mesh or a terrain may have: a picture would take many milliseconds.
inline constexpr std::size_t kMostTriangles = 20'000;

/// A frame around an opening with `sides` even sides, one of them at the bottom; flat sides of the opening are
/// `inner_m` apart, those of the frame `outer_m`. Gate frame: origin in the middle of the opening, x as flown.
Mesh ring(int sides, double inner_m, double outer_m, double thickness_m, const Texture& texture);

/// A surface over a grid: `heights_m[row][column]` above the point (column, row) x `spacing_m`; rows run north,
/// columns east. All rows are equally long. The origin is the south west corner on z = 0.
Mesh height_field(const std::vector<std::vector<double>>& heights_m, double spacing_m, const Texture& texture);

}  // namespace mebots::world::scene
