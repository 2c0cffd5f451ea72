// SPDX-License-Identifier: Apache-2.0
#include "scene/mesh.hpp"

#include "mebots/assert.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace mebots::world::scene {

Eigen::Vector3d Mesh::normal(const Triangle& triangle) const {
  const auto& [a, b, c] = triangle.corners;
  MEBOTS_ASSERT(a < points_m.size() && b < points_m.size() && c < points_m.size());
  const Eigen::Vector3d across = (points_m[b] - points_m[a]).cross(points_m[c] - points_m[a]);
  const double length = across.norm();
  return length > 0.0 ? Eigen::Vector3d(across / length) : Eigen::Vector3d::Zero();
}

double Mesh::radius_m() const {
  double radius_m = 0.0;
  for (const auto& point : points_m) radius_m = std::max(radius_m, point.norm());
  return radius_m;
}

Mesh ring(int sides, double inner_m, double outer_m, double thickness_m, const Texture& texture) {
  MEBOTS_ASSERT(sides >= 3 && inner_m > 0 && outer_m > inner_m && thickness_m > 0);
  Mesh mesh;
  mesh.materials = {texture};
  const double half_rad = std::numbers::pi / sides;
  // The first corner is half a side from the middle of the bottom. Each corner has four points: inner and outer at
  // -thickness_m / 2, then inner and outer at thickness_m / 2.
  for (int i = 0; i < sides; ++i) {
    const double angle_rad = -0.5 * std::numbers::pi + (2 * i - 1) * half_rad;
    const Eigen::Vector3d out{0.0, -std::cos(angle_rad) / std::cos(half_rad), std::sin(angle_rad) / std::cos(half_rad)};
    for (const double x_m : {-0.5 * thickness_m, 0.5 * thickness_m}) {
      for (const double across_m : {inner_m, outer_m}) {
        mesh.points_m.push_back(0.5 * across_m * out + Eigen::Vector3d(x_m, 0.0, 0.0));
      }
    }
  }
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({{a, b, c}, 0, {}});
    mesh.triangles.push_back({{a, c, d}, 0, {}});
  };
  const auto count = static_cast<std::uint32_t>(sides);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t here = 4 * i;
    const std::uint32_t next = 4 * ((i + 1) % count);
    quad(here, here + 1, next + 1, next);          // front side, which faces the approaching drone
    quad(here + 2, next + 2, next + 3, here + 3);  // back side
    quad(here, next, next + 2, here + 2);          // side towards the opening
    quad(here + 1, here + 3, next + 3, next + 1);  // outer side
  }
  return mesh;
}

Mesh height_field(const std::vector<std::vector<double>>& heights_m, double spacing_m, const Texture& texture) {
  MEBOTS_ASSERT(heights_m.size() >= 2 && heights_m[0].size() >= 2 && spacing_m > 0);
  Mesh mesh;
  mesh.materials = {texture};
  const auto columns = static_cast<std::uint32_t>(heights_m[0].size());
  const auto rows = static_cast<std::uint32_t>(heights_m.size());
  for (std::uint32_t row = 0; row < rows; ++row) {
    MEBOTS_ASSERT(heights_m[row].size() == columns);
    for (std::uint32_t column = 0; column < columns; ++column) {
      mesh.points_m.emplace_back(column * spacing_m, row * spacing_m, heights_m[row][column]);
    }
  }
  for (std::uint32_t row = 0; row + 1 < rows; ++row) {
    for (std::uint32_t column = 0; column + 1 < columns; ++column) {
      const std::uint32_t corner = row * columns + column;
      mesh.triangles.push_back({{corner, corner + 1, corner + columns + 1}, 0, {}});
      mesh.triangles.push_back({{corner, corner + columns + 1, corner + columns}, 0, {}});
    }
  }
  return mesh;
}

}  // namespace mebots::world::scene
