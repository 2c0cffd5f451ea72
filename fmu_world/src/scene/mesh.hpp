// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/png_file.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace mebots::world::scene {

using Picture = GreyPicture;

/// The reflection of a surface. Grey levels are from 0 (black) to 255 (white). They are the levels in the camera's
/// picture if the light on the surface is 1.
struct Texture {
  enum class Kind {
    uniform,  ///< `light` at every point
    checker,  ///< alternating squares, whose edges are `scale_m` long
    stripes,  ///< alternating bands of width `scale_m` across the surface's first axis
    noise,    ///< smooth value noise between `dark` and `light`, lattice of `scale_m`
    bricks,   ///< `light` bricks 2 scale_m x scale_m, every second row shifted by half, joints `dark`
    picture,  ///< `picture`, `scale_m` wide, upright, repeated; black becomes `dark`, white becomes `light`
  };
  Kind kind = Kind::uniform;
  double light = 200.0;    ///< grey level, 0..255
  double dark = 100.0;     ///< grey level, 0..255
  double scale_m = 0.5;    ///< size of the pattern's element, > 0
  std::uint32_t seed = 0;  ///< of `noise`, and of the small differences between the grey levels of bricks
  std::shared_ptr<const Picture> picture = nullptr;

  bool operator==(const Texture& other) const {
    const bool same_picture = picture == other.picture || (picture && other.picture && *picture == *other.picture);
    return kind == other.kind && light == other.light && dark == other.dark && scale_m == other.scale_m &&
           seed == other.seed && same_picture;
  }
};

/// A surface of triangles in its own frame (x forward, y left, z up, metres).
struct Mesh {
  struct Triangle {
    std::array<std::uint32_t, 3> corners{};  ///< indices in `points_m`, counter-clockwise seen from outside
    std::uint32_t material = 0;              ///< index in `materials`
    /// Texture coordinates of the corners in tiles, u to the right and v up. If absent, the texture coordinates are
    /// lengths in metres along two axes of the mesh: the two axes that are most perpendicular to the normal.
    std::optional<std::array<Eigen::Vector2d, 3>> tiles;
  };

  std::vector<Eigen::Vector3d> points_m;
  std::vector<Triangle> triangles;
  std::vector<Texture> materials;

  /// Returns the unit normal of a triangle in the mesh's frame. If the triangle has no area, returns zero.
  Eigen::Vector3d normal(const Triangle& triangle) const;
  /// Returns the distance from the origin to the farthest point.
  double radius_m() const;
};

/// The greatest number of triangles of a mesh or a terrain. A picture with more triangles would take many milliseconds.
inline constexpr std::size_t kMostTriangles = 20'000;

/// Creates a frame around an opening with `sides` equal sides. One side is at the bottom. The distance between opposite
/// sides is `inner_m` at the opening, and `outer_m` at the outside of the frame. The origin is in the middle of the
/// opening, and x is the direction of flight.
Mesh ring(int sides, double inner_m, double outer_m, double thickness_m, const Texture& texture);

/// Returns a surface over a grid. `heights_m[row][column]` is the height at the point (column, row) x `spacing_m`. Rows
/// proceed to the north, columns to the east. All rows must have the same length. The origin is the south-west corner
/// at z = 0.
Mesh height_field(const std::vector<std::vector<double>>& heights_m, double spacing_m, const Texture& texture);

}  // namespace mebots::world::scene
