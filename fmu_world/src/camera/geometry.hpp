// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/tile.hpp"
#include "scene/scene.hpp"

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace mebots::world::camera {

/// Corners that a face may have.
inline constexpr std::size_t kMaxCorners = 8;

/// A flat convex piece of a surface, seen from its front only.
///
/// Depth, texture and light come from the plane and the mapping, never from the corners: these only say
/// what is covered. So the pieces into which a face is cut look exactly as the whole.
struct Face {
  Eigen::Vector3d normal_W;                  ///< unit, out of the front
  double offset_m = 0.0;                     ///< the plane is normal . p = offset
  std::vector<Eigen::Vector3d> corners_W_m;  ///< 3..kMaxCorners, counter-clockwise seen from the front
  std::size_t tile = 0;                      ///< index in Geometry::tiles
  Eigen::Vector3d u_axis_W;            ///< along the surface's first axis; unit where the texture has its own size
  Eigen::Vector3d v_axis_W;            ///< along the second axis
  Eigen::Vector3d texture_origin_W_m;  ///< where the texture's coordinates are these two:
  double u_origin_m = 0.0;
  double v_origin_m = 0.0;
  double light = 1.0;           ///< grey level seen over grey level of the texture; of what moves, where it begins
  std::size_t mover = kStatic;  ///< index in Geometry::movers
  static constexpr std::size_t kStatic = SIZE_MAX;
};

/// Faces that move together: they turn about the vertical through `origin_W_m` and are then shifted.
struct Mover {
  scene::Path path;
  Eigen::Vector3d origin_W_m;
};

/// What the camera can see.
struct Geometry {
  std::vector<std::shared_ptr<const Tile>> tiles;
  std::vector<Face> faces;  ///< of movers, where they are without their path
  std::vector<Mover> movers;
  scene::Lighting lighting;  ///< of what turns
  double background = 0.0;   ///< grey level where there is no face
};

/// Light on a surface, after Lambert: ambient + sun max(0, normal . to_sun).
double lambert(const scene::Lighting& lighting, const Eigen::Vector3d& normal_W);

/// Builds ground, boxes, cylinders, meshes and gates (of those with beams the outside of Gate::beams()). Texture axes:
/// the ground's are world x and y from the world's origin; a mesh's own, or those of its frame. A cylinder has 32
/// sides. Upright sides have the first axis horizontal to the right and the second one up, from the lower left corner
/// as seen from outside. A gate's front and back have one pattern over the whole frame. Tops and bottoms have the
/// solid's x and y from their corner of least x and y. Undersides of boxes at or below the ground are left out, since
/// nobody can see them. There are no shadows.
Geometry make_geometry(const scene::Scene& scene);

}  // namespace mebots::world::camera
