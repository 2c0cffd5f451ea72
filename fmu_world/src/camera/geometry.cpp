// SPDX-License-Identifier: Apache-2.0
#include "camera/geometry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace mebots::world::camera {
namespace {

using Eigen::Vector3d;

Vector3d cross(const Vector3d& a, const Vector3d& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}

/// Where a solid stands and what it is painted with.
struct Solid {
  std::array<Vector3d, 3> axes_W;  // unit; the last one is up
  std::size_t tile;
  const scene::Lighting& lighting;
};

std::array<Vector3d, 3> turned_axes(double yaw_rad) {
  const double c = std::cos(yaw_rad);
  const double s = std::sin(yaw_rad);
  return {Vector3d(c, s, 0.0), Vector3d(-s, c, 0.0), Vector3d::UnitZ()};
}

/// Adds a side of a solid that faces along `sign` times its axis `axis`. `corners` may run either way round.
void add_side(Geometry& geometry, const Solid& solid, int axis, double sign, std::vector<Vector3d> corners) {
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
  geometry.faces.push_back(std::move(face));
}

/// Corners are computed once for all sides of a solid: sides that share an edge must share its bits.
void add_box(Geometry& geometry, const scene::Box& box, std::size_t tile, const scene::Lighting& lighting) {
  const Solid solid{turned_axes(box.yaw_rad), tile, lighting};
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
      if (axis == 2 && far == 0 && corners[first].z() <= 0.0) continue;
      add_side(geometry, solid, axis, far != 0 ? 1.0 : -1.0,
               {corners[first], corners[first + a], corners[first + a + b], corners[first + b]});
    }
  }
}

/// The outside of a gate's four beams together. Where beams meet, their faces have the same corners, even in
/// the middle of an edge: so no background shines through a joint.
void add_gate(Geometry& geometry, const scene::Gate& gate, std::size_t tile, const scene::Lighting& lighting) {
  const Solid solid{turned_axes(gate.yaw_rad), tile, lighting};
  const std::array<double, 4> across{-0.5 * gate.outer_m, -0.5 * gate.inner_m, 0.5 * gate.inner_m, 0.5 * gate.outer_m};
  const auto at = [&](int far, int y, int z) -> Vector3d {
    return gate.p_W_m + (far - 0.5) * gate.thickness_m * solid.axes_W[0] + across[y] * solid.axes_W[1] +
           across[z] * solid.axes_W[2];
  };
  for (const int far : {0, 1}) {
    const auto front = [&](const std::vector<std::pair<int, int>>& ring) {
      std::vector<Vector3d> corners;
      corners.reserve(ring.size());
      for (const auto& [y, z] : ring) corners.push_back(at(far, y, z));
      add_side(geometry, solid, 0, far != 0 ? 1.0 : -1.0, std::move(corners));
      // One pattern over the whole frame.
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

/// The place of the texture's tile in `geometry`, added if it is new.
std::size_t add_tile(Geometry& geometry, const scene::Texture& texture) {
  auto& tiles = geometry.tiles;
  const auto tile = shared_tile(texture);  // one for equal textures
  const auto found = std::find(tiles.begin(), tiles.end(), tile);
  const auto place = static_cast<std::size_t>(found - tiles.begin());
  if (found == tiles.end()) tiles.push_back(tile);
  return place;
}

}  // namespace

double lambert(const scene::Lighting& lighting, const Vector3d& normal_W) {
  return lighting.ambient + lighting.sun * std::max(0.0, normal_W.dot(lighting.to_sun_W));
}

Geometry make_geometry(const scene::Scene& scene) {
  Geometry geometry;
  geometry.background = scene.lighting.background;

  const Solid earth{turned_axes(0.0), add_tile(geometry, scene.ground.texture), scene.lighting};
  const double half_m = scene.ground.half_size_m;
  add_side(geometry, earth, 2, 1.0,
           {{-half_m, -half_m, 0.0}, {half_m, -half_m, 0.0}, {half_m, half_m, 0.0}, {-half_m, half_m, 0.0}});
  geometry.faces.back().texture_origin_W_m = Vector3d::Zero();

  for (const scene::Box& box : scene.boxes) {
    add_box(geometry, box, add_tile(geometry, box.texture), scene.lighting);
  }
  for (const scene::Gate& gate : scene.gates) {
    add_gate(geometry, gate, add_tile(geometry, gate.texture), scene.lighting);
  }
  return geometry;
}

}  // namespace mebots::world::camera
