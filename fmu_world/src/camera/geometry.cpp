// SPDX-License-Identifier: Apache-2.0
#include "camera/geometry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace mebots::world::camera {
namespace {

using Eigen::Vector3d;

Vector3d cross(const Vector3d& a, const Vector3d& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}

struct Painted {
  std::array<Vector3d, 3> axes_W;  // unit vectors; the last one is the solid's own up
  std::size_t tile;
  const scene::Lighting& lighting;
  std::size_t mover = Face::kStatic;
};

template <typename Thing>
std::array<Vector3d, 3> axes_of(const Thing& thing) {
  if (thing.pitch_rad == 0.0 && thing.roll_rad == 0.0) {
    const double c = std::cos(thing.yaw_rad);
    const double s = std::sin(thing.yaw_rad);
    return {Vector3d(c, s, 0.0), Vector3d(-s, c, 0.0), Vector3d::UnitZ()};
  }
  const Eigen::Matrix3d R = scene::attitude_of(thing).toRotationMatrix();
  return {R.col(0), R.col(1), R.col(2)};
}

/// If an object moves on a path, adds a Mover for its faces and returns the Mover's index. Otherwise returns kStatic.
template <typename Thing>
std::size_t add_mover(Geometry& geometry, const Thing& thing) {
  if (!thing.path.moves()) return Face::kStatic;
  geometry.movers.push_back({thing.path, thing.p_W_m});
  return geometry.movers.size() - 1;
}

/// Adds the side of a solid with the normal `sign` times its axis `axis`. `corners` may have either orientation.
void add_side(Geometry& geometry, const Painted& solid, int axis, double sign, std::vector<Vector3d> corners) {
  Face face;
  face.normal_W = sign * solid.axes_W[axis];
  face.offset_m = face.normal_W.dot(corners[0]);
  const bool upright = axis != 2;
  face.u_axis_W = upright ? cross(solid.axes_W[2], face.normal_W) : solid.axes_W[0];
  face.v_axis_W = upright ? solid.axes_W[2] : solid.axes_W[1];
  const auto along_diagonal = [&](const Vector3d& p) { return face.u_axis_W.dot(p) + face.v_axis_W.dot(p); };
  face.texture_origin_W_m =
      *std::min_element(corners.begin(), corners.end(),
                        [&](const Vector3d& a, const Vector3d& b) { return along_diagonal(a) < along_diagonal(b); });
  Vector3d twice_area = Vector3d::Zero();
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    twice_area += cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
  if (twice_area.dot(face.normal_W) < 0.0) std::reverse(corners.begin(), corners.end());
  face.corners_W_m = std::move(corners);
  face.tile = solid.tile;
  face.light = lambert(solid.lighting, face.normal_W);
  face.mover = solid.mover;
  geometry.faces.push_back(std::move(face));
}

/// Adds the sides of a box. Computes each corner once, because sides with a common edge must have corners with the same
/// bits.
void add_box(Geometry& geometry, const scene::Box& box, std::size_t tile, const scene::Lighting& lighting,
             std::size_t mover) {
  const Painted solid{axes_of(box), tile, lighting, mover};
  std::array<Vector3d, 8> corners;  // bit k of the index set: on the far side along axis k
  for (int i = 0; i < 8; ++i) {
    corners[i] = box.p_W_m;
    for (int k = 0; k < 3; ++k) corners[i] += ((i >> k & 1) != 0 ? 0.5 : -0.5) * box.size_m[k] * solid.axes_W[k];
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int a = 1 << (axis + 1) % 3;
    const int b = 1 << (axis + 2) % 3;
    for (const int far : {0, 1}) {
      const int first = far << axis;
      std::vector<Vector3d> side{corners[first], corners[first + a], corners[first + a + b], corners[first + b]};
      const bool below = std::all_of(side.begin(), side.end(), [](const Vector3d& p) { return p.z() <= 0.0; });
      if (axis == 2 && far == 0 && below && solid.mover == Face::kStatic) continue;
      add_side(geometry, solid, axis, far != 0 ? 1.0 : -1.0, std::move(side));
    }
  }
}

/// Adds the outside of a gate's four beams. Where two beams meet, their faces have common corners, even in the middle
/// of an edge. Therefore no background is visible between the beams.
void add_gate(Geometry& geometry, const scene::Gate& gate, std::size_t tile, const scene::Lighting& lighting) {
  const Painted solid{axes_of(gate), tile, lighting};
  const double outer_height_m = gate.frame_height_m();
  const double inner_height_m = gate.opening_height_m();
  const std::array<double, 4> across{-0.5 * gate.outer_m, -0.5 * gate.inner_m, 0.5 * gate.inner_m, 0.5 * gate.outer_m};
  const std::array<double, 4> up{-0.5 * outer_height_m, -0.5 * inner_height_m, 0.5 * inner_height_m,
                                 0.5 * outer_height_m};
  const auto at = [&](int far, int y, int z) -> Vector3d {
    return gate.p_W_m + (far - 0.5) * gate.thickness_m * solid.axes_W[0] + across[y] * solid.axes_W[1] +
           up[z] * solid.axes_W[2];
  };
  for (const int far : {0, 1}) {
    const auto front = [&](const std::vector<std::pair<int, int>>& ring) {
      std::vector<Vector3d> corners;
      corners.reserve(ring.size());
      for (const auto& [y, z] : ring) corners.push_back(at(far, y, z));
      add_side(geometry, solid, 0, far != 0 ? 1.0 : -1.0, std::move(corners));
      // All sides of the frame share one texture origin, so that the pattern has no breaks.
      geometry.faces.back().texture_origin_W_m = at(far, far != 0 ? 0 : 3, 0);
    };
    front({{3, 0}, {2, 0}, {2, 1}, {2, 2}, {2, 3}, {3, 3}});  // left
    front({{0, 0}, {1, 0}, {1, 1}, {1, 2}, {1, 3}, {0, 3}});  // right
    front({{1, 2}, {2, 2}, {2, 3}, {1, 3}});                  // top
    front({{1, 0}, {2, 0}, {2, 1}, {1, 1}});                  // bottom
  }
  for (const int high : {0, 1}) {
    const double sign = high != 0 ? 1.0 : -1.0;
    const int outer = high != 0 ? 3 : 0;
    const int inner = high != 0 ? 2 : 1;
    add_side(geometry, solid, 1, sign, {at(0, outer, 0), at(1, outer, 0), at(1, outer, 3), at(0, outer, 3)});
    add_side(geometry, solid, 1, -sign, {at(0, inner, 1), at(1, inner, 1), at(1, inner, 2), at(0, inner, 2)});
    add_side(geometry, solid, 2, sign,
             {at(0, 0, outer), at(0, 1, outer), at(0, 2, outer), at(0, 3, outer), at(1, 3, outer), at(1, 2, outer),
              at(1, 1, outer), at(1, 0, outer)});
    add_side(geometry, solid, 2, -sign, {at(0, 1, inner), at(1, 1, inner), at(1, 2, inner), at(0, 2, inner)});
  }
}

/// Adds a cylinder: its side as flat strips with one texture, and its ends as several faces.
void add_cylinder(Geometry& geometry, const scene::Cylinder& cylinder, std::size_t tile,
                  const scene::Lighting& lighting, std::size_t mover) {
  constexpr int kSides = 32;
  const Painted solid{axes_of(cylinder), tile, lighting, mover};
  const auto& [x_W, y_W, z_W] = solid.axes_W;
  std::array<std::array<Vector3d, kSides>, 2> rims;  // lower and upper
  for (int i = 0; i < kSides; ++i) {
    const double angle_rad = 2.0 * std::numbers::pi * i / kSides;
    const Vector3d out_W = cylinder.radius_m * (std::cos(angle_rad) * x_W + std::sin(angle_rad) * y_W);
    rims[0][i] = cylinder.p_W_m + out_W - 0.5 * cylinder.height_m * z_W;
    rims[1][i] = cylinder.p_W_m + out_W + 0.5 * cylinder.height_m * z_W;
  }
  for (int i = 0; i < kSides; ++i) {
    const int next = (i + 1) % kSides;
    Face face;
    face.corners_W_m = {rims[0][i], rims[0][next], rims[1][next], rims[1][i]};
    const Vector3d along = rims[0][next] - rims[0][i];
    face.u_axis_W = along / along.norm();
    face.v_axis_W = z_W;
    face.normal_W = cross(face.u_axis_W, z_W);
    face.offset_m = face.normal_W.dot(rims[0][i]);
    face.texture_origin_W_m = rims[0][i];
    face.u_origin_m = i * along.norm();
    face.tile = tile;
    face.light = lambert(lighting, face.normal_W);
    face.mover = solid.mover;
    geometry.faces.push_back(std::move(face));
  }
  for (const int high : {0, 1}) {
    // Divides the end into fans from the first corner. Each fan has at most kMaxCorners corners.
    for (int first = 1; first + 1 < kSides; first += static_cast<int>(kMaxCorners) - 2) {
      std::vector<Vector3d> piece{rims[high][0]};
      const int last = std::min(first + static_cast<int>(kMaxCorners) - 2, kSides - 1);
      for (int i = first; i <= last; ++i) piece.push_back(rims[high][i]);
      add_side(geometry, solid, 2, high != 0 ? 1.0 : -1.0, std::move(piece));
      geometry.faces.back().texture_origin_W_m = cylinder.p_W_m;
    }
  }
}

/// Returns the axes u (to the right) and v (up) of a texture on a triangle without texture coordinates. They are the
/// two axes of the mesh's frame that are most perpendicular to the triangle's normal.
std::array<Vector3d, 2> axes_on(const Vector3d& normal_M) {
  int most = 2;
  for (const int axis : {0, 1}) {
    if (std::abs(normal_M[axis]) > std::abs(normal_M[most])) most = axis;
  }
  const double sign = normal_M[most] < 0.0 ? -1.0 : 1.0;
  if (most == 0) return {sign * Vector3d::UnitY(), Vector3d::UnitZ()};
  if (most == 1) return {-sign * Vector3d::UnitX(), Vector3d::UnitZ()};
  return {Vector3d::UnitX(), Vector3d::UnitY()};
}

/// Sets the texture coordinates of a face as a linear function that has the given values at the triangle's corners.
void lay_tiles(Face& face, const std::array<Eigen::Vector2d, 3>& tiles, const Tile& tile) {
  const Vector3d e1 = face.corners_W_m[1] - face.corners_W_m[0];
  const Vector3d e2 = face.corners_W_m[2] - face.corners_W_m[0];
  const Vector3d across = cross(e1, e2);
  const double square = across.squaredNorm();
  const Vector3d along_1 = cross(e2, across) / square;  // along_1 . e1 = 1, along_1 . e2 = 0
  const Vector3d along_2 = cross(across, e1) / square;
  const Eigen::Vector2d d1 = tiles[1] - tiles[0];
  const Eigen::Vector2d d2 = tiles[2] - tiles[0];
  face.u_axis_W = tile.edge_u_m * (d1.x() * along_1 + d2.x() * along_2);
  face.v_axis_W = tile.edge_v_m * (d1.y() * along_1 + d2.y() * along_2);
  face.texture_origin_W_m = face.corners_W_m[0];
  face.u_origin_m = tile.edge_u_m * tiles[0].x();
  face.v_origin_m = tile.edge_v_m * tiles[0].y();
}

/// Returns the index of the texture's tile in `geometry`. Adds the tile if it is new.
std::size_t add_tile(Geometry& geometry, const scene::Texture& texture) {
  auto& tiles = geometry.tiles;
  const auto tile = shared_tile(texture);  // one for equal textures
  const auto found = std::find(tiles.begin(), tiles.end(), tile);
  const auto place = static_cast<std::size_t>(found - tiles.begin());
  if (found == tiles.end()) tiles.push_back(tile);
  return place;
}

/// Adds a mesh. Computes each point once, because triangles with a common edge must have points with the same bits.
void add_mesh(Geometry& geometry, const scene::Mesh& mesh, const Vector3d& p_W_m, const Eigen::Matrix3d& R_WM,
              const scene::Lighting& lighting, std::size_t mover) {
  std::vector<Vector3d> points_W;
  points_W.reserve(mesh.points_m.size());
  for (const Vector3d& point : mesh.points_m) points_W.push_back(p_W_m + R_WM * point);
  std::vector<std::size_t> tiles;
  for (const auto& material : mesh.materials) tiles.push_back(add_tile(geometry, material));
  for (const auto& triangle : mesh.triangles) {
    const Vector3d normal_M = mesh.normal(triangle);
    if (normal_M.isZero()) continue;
    Face face;
    for (const std::uint32_t corner : triangle.corners) face.corners_W_m.push_back(points_W[corner]);
    const Vector3d across = cross(face.corners_W_m[1] - face.corners_W_m[0], face.corners_W_m[2] - face.corners_W_m[0]);
    face.normal_W = across / across.norm();
    face.offset_m = face.normal_W.dot(face.corners_W_m[0]);
    face.tile = tiles[triangle.material];
    if (triangle.tiles) {
      lay_tiles(face, *triangle.tiles, *geometry.tiles[face.tile]);
    } else {
      const auto [u_M, v_M] = axes_on(normal_M);
      face.u_axis_W = R_WM * u_M;
      face.v_axis_W = R_WM * v_M;
      face.texture_origin_W_m = p_W_m;
    }
    face.light = lambert(lighting, face.normal_W);
    face.mover = mover;
    geometry.faces.push_back(std::move(face));
  }
}

void add_object(Geometry& geometry, const SceneObject& object, std::size_t first_face) {
  const auto index = static_cast<std::uint32_t>(geometry.objects.size());
  geometry.objects.push_back(object);
  for (std::size_t i = first_face; i < geometry.faces.size(); ++i) geometry.faces[i].object = index;
}

/// Adds the boxes, cylinders and meshes of a scene or robot. `mover_of` returns an object's index in
/// Geometry::movers, or kStatic.
template <typename Things, typename MoverOf>
void add_things(Geometry& geometry, const Things& things, MoverOf mover_of) {
  for (const scene::Box& box : things.boxes) {
    const std::size_t tile = add_tile(geometry, box.texture);
    add_box(geometry, box, tile, geometry.lighting, mover_of(box));
  }
  for (const scene::Cylinder& cylinder : things.cylinders) {
    const std::size_t tile = add_tile(geometry, cylinder.texture);
    add_cylinder(geometry, cylinder, tile, geometry.lighting, mover_of(cylinder));
  }
  for (const scene::MeshThing& thing : things.meshes) {
    const Eigen::Matrix3d R_WM = scene::attitude_of(thing).toRotationMatrix();
    add_mesh(geometry, *thing.mesh, thing.p_W_m, R_WM, geometry.lighting, mover_of(thing));
  }
}

}  // namespace

double lambert(const scene::Lighting& lighting, const Vector3d& normal_W) {
  return lighting.ambient + lighting.sun * std::max(0.0, normal_W.dot(lighting.to_sun_W));
}

Geometry make_geometry(const scene::Scene& scene) {
  Geometry geometry;
  geometry.lighting = scene.lighting;
  geometry.background = scene.lighting.background;

  const Painted earth{{Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()},
                      add_tile(geometry, scene.ground.texture),
                      scene.lighting};
  const double half_m = scene.ground.half_size_m;
  add_side(geometry, earth, 2, 1.0,
           {{-half_m, -half_m, 0.0}, {half_m, -half_m, 0.0}, {half_m, half_m, 0.0}, {-half_m, half_m, 0.0}});
  geometry.faces.back().texture_origin_W_m = Vector3d::Zero();

  add_things(geometry, scene, [&](const auto& thing) { return add_mover(geometry, thing); });
  for (const scene::Gate& gate : scene.gates) {
    const std::size_t first_face = geometry.faces.size();
    if (gate.has_beams()) {
      add_gate(geometry, gate, add_tile(geometry, gate.texture), scene.lighting);
    } else {
      const Eigen::Matrix3d R_WG = scene::attitude_of(gate).toRotationMatrix();
      add_mesh(geometry, gate.frame(), gate.p_W_m, R_WG, scene.lighting, Face::kStatic);
    }
    add_object(geometry, {SceneObject::Kind::gate, gate.name, gate.p_W_m}, first_face);
  }
  return geometry;
}

void add_robot(Geometry& geometry, const scene::Robot& robot, std::size_t body) {
  const std::size_t mover = geometry.movers.size();
  geometry.movers.push_back({{}, Vector3d::Zero(), body});
  add_things(geometry, robot, [mover](const auto&) { return mover; });
}

void add_drone(Geometry& geometry, const scene::Drone& drone, std::size_t body) {
  constexpr int kSides = 8;
  constexpr std::array<std::pair<int, int>, 4> kRotors{{{1, -1}, {-1, -1}, {-1, 1}, {1, 1}}};
  scene::Texture dark;
  dark.light = 60.0;
  scene::Texture darker;
  darker.light = 30.0;
  const std::size_t first_face = geometry.faces.size();
  const std::size_t mover = geometry.movers.size();
  geometry.movers.push_back({{}, Vector3d::Zero(), body});
  scene::Box box;
  box.size_m = drone.body_size_m;
  add_box(geometry, box, add_tile(geometry, dark), geometry.lighting, mover);
  const Painted disc{
      {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()}, add_tile(geometry, darker), geometry.lighting, mover};
  for (const auto& [x, y] : kRotors) {
    std::vector<Vector3d> rim;
    for (int i = 0; i < kSides; ++i) {
      const double angle_rad = 2.0 * std::numbers::pi * i / kSides;
      rim.push_back({drone.arm_m * (x + kRotorRadiusOverArm * std::cos(angle_rad)),
                     drone.arm_m * (y + kRotorRadiusOverArm * std::sin(angle_rad)), 0.5 * drone.body_size_m.z()});
    }
    add_side(geometry, disc, 2, 1.0, rim);
    add_side(geometry, disc, 2, -1.0, rim);
  }
  const std::string name = "drone[" + std::to_string(body + 1) + "]";
  add_object(geometry, {SceneObject::Kind::drone, name, Vector3d::Zero(), body}, first_face);
}

}  // namespace mebots::world::camera
