// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/tile.hpp"
#include "scene/scene.hpp"

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace mebots::world::camera {

inline constexpr std::size_t kMaxCorners = 8;

/// Marks a face that is not part of a named object.
inline constexpr std::uint32_t kNoObject = UINT32_MAX;

/// A flat convex part of a surface, visible only from its front.
///
/// The depth, texture and light at a point depend only on the plane and the texture axes. The corners only determine
/// the covered pixels. Therefore the parts of a divided face look exactly like the whole face.
struct Face {
  Eigen::Vector3d normal_W;                  ///< unit, out of the front
  double offset_m = 0.0;                     ///< the plane is normal . p = offset
  std::vector<Eigen::Vector3d> corners_W_m;  ///< 3..kMaxCorners, counter-clockwise seen from the front
  std::size_t tile = 0;                      ///< index in Geometry::tiles
  Eigen::Vector3d u_axis_W;            ///< along the surface's first axis; unit where the texture has its own size
  Eigen::Vector3d v_axis_W;            ///< along the second axis
  Eigen::Vector3d texture_origin_W_m;  ///< point where both texture coordinates are these:
  double u_origin_m = 0.0;
  double v_origin_m = 0.0;
  std::uint32_t object = kNoObject;  ///< index in Geometry::objects
  double light = 1.0;                ///< grey level seen over grey level of the texture; for moving faces, at the start
  std::size_t mover = kStatic;       ///< index in Geometry::movers
  static constexpr std::size_t kStatic = SIZE_MAX;
};

/// Moves a set of faces together. On a path, the faces rotate about the vertical through `origin_W_m`, and are then
/// shifted. If the faces belong to a drone or robot, their corners are in the body's frame.
struct Mover {
  static constexpr std::size_t kNoBody = SIZE_MAX;
  scene::Path path;
  Eigen::Vector3d origin_W_m;
  std::size_t body = kNoBody;  ///< index of the drone or robot in Pose::bodies
};

/// A named object. Ground truth marks its faces in a picture.
struct SceneObject {
  enum class Kind { gate, drone };
  Kind kind = Kind::gate;
  std::string name;
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();  ///< in the world; of a drone: in its body's frame
  std::size_t body = Mover::kNoBody;                   ///< index of a drone in Pose::bodies
};

struct Geometry {
  std::vector<std::shared_ptr<const Tile>> tiles;
  std::vector<Face> faces;  ///< faces of movers are in their positions without a path
  std::vector<Mover> movers;
  std::vector<SceneObject> objects;
  scene::Lighting lighting;  ///< for faces that rotate
  double background = 0.0;   ///< grey level where no face is
};

/// Returns the light on a surface by Lambert's law: ambient + sun max(0, normal . to_sun).
double lambert(const scene::Lighting& lighting, const Eigen::Vector3d& normal_W);

/// Builds the faces of the ground, and of a scene's boxes, cylinders, meshes and gates. A gate with beams gets the
/// outer faces of its four beams. A cylinder has 32 sides. Undersides of boxes at or below the ground are omitted,
/// because they are never visible. There are no shadows. Axes of the textures: the ground uses the world's x and y from
/// the origin. A mesh uses its texture coordinates. Without them, it uses two axes of its frame. On vertical sides, the
/// first axis is horizontal to the right and the second axis is up, from the lower left corner seen from outside. A
/// gate's front and back share one pattern. Tops and bottoms use the solid's x and y, from the corner with the least x
/// and y.
Geometry make_geometry(const scene::Scene& scene);

/// The radius of a rotor's disc, divided by the rotor's distance from the centre along x. Neighbouring discs do not
/// touch.
inline constexpr double kRotorRadiusOverArm = 0.7;

/// Adds a drone as other drones see it: its contact box, and an octagon on top of the box for each rotor.
void add_drone(Geometry& geometry, const scene::Drone& drone, std::size_t body);
void add_robot(Geometry& geometry, const scene::Robot& robot, std::size_t body);

}  // namespace mebots::world::camera
