// SPDX-License-Identifier: Apache-2.0
#include "sensors/ray_caster.hpp"

#include "math/rotation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace mebots::world {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

struct Ray {
  Eigen::Vector3d p;
  Eigen::Vector3d d;
};

/// Returns the distance at which the ray enters the box. If the ray misses the box or starts inside, returns infinity.
double entry_of_box(const Ray& ray, const Eigen::Vector3d& size_m) {
  double enter = 0.0;
  double leave = kFar;
  for (int axis = 0; axis < 3; ++axis) {
    const double half = 0.5 * size_m[axis];
    if (ray.d[axis] == 0.0) {
      if (ray.p[axis] < -half || ray.p[axis] > half) return kFar;
      continue;
    }
    double near = (-half - ray.p[axis]) / ray.d[axis];
    double far = (half - ray.p[axis]) / ray.d[axis];
    if (near > far) std::swap(near, far);
    enter = std::max(enter, near);
    leave = std::min(leave, far);
  }
  return enter > 0.0 && enter <= leave ? enter : kFar;
}

/// Returns the distance at which the ray enters a cylinder along z: |p + t d| = r in x and y, and |z| at most half the
/// height.
double entry_of_cylinder(const Ray& ray, const Eigen::Vector3d& size_m) {
  double enter = 0.0;
  double leave = kFar;
  const double radius = 0.5 * size_m.x();
  const double a = ray.d.head<2>().squaredNorm();
  const double c = ray.p.head<2>().squaredNorm() - radius * radius;
  if (a == 0.0) {
    if (c > 0.0) return kFar;
  } else {
    const double b = ray.p.head<2>().dot(ray.d.head<2>());
    const double square = b * b - a * c;
    if (square < 0.0) return kFar;
    enter = std::max(enter, (-b - std::sqrt(square)) / a);
    leave = std::min(leave, (-b + std::sqrt(square)) / a);
  }
  const double half = 0.5 * size_m.z();
  if (ray.d.z() == 0.0) {
    if (std::abs(ray.p.z()) > half) return kFar;
  } else {
    const double one = (-half - ray.p.z()) / ray.d.z();
    const double other = (half - ray.p.z()) / ray.d.z();
    enter = std::max(enter, std::min(one, other));
    leave = std::min(leave, std::max(one, other));
  }
  return enter > 0.0 && enter <= leave ? enter : kFar;
}

/// Returns the distance to the nearest triangle whose front the ray meets (Moeller and Trumbore 1997).
double entry_of_mesh(const Ray& ray, const scene::Mesh& mesh) {
  double nearest = kFar;
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d& corner = mesh.points_m[triangle.corners[0]];
    const Eigen::Vector3d e1 = mesh.points_m[triangle.corners[1]] - corner;
    const Eigen::Vector3d e2 = mesh.points_m[triangle.corners[2]] - corner;
    const Eigen::Vector3d across = ray.d.cross(e2);
    const double determinant = e1.dot(across);
    if (determinant <= 0.0) continue;  // back or edge-on
    const Eigen::Vector3d from_corner = ray.p - corner;
    const double u = from_corner.dot(across);
    if (u < 0.0 || u > determinant) continue;
    const Eigen::Vector3d q = from_corner.cross(e1);
    const double v = ray.d.dot(q);
    if (v < 0.0 || u + v > determinant) continue;
    const double t = e2.dot(q) / determinant;
    if (t > 0.0) nearest = std::min(nearest, t);
  }
  return nearest;
}

double entry(const scene::Solid& solid, std::int64_t time_ns, const Ray& ray_W) {
  const scene::Displacement moved = solid.path.at(time_ns);
  const Eigen::Vector3d p_W_m = solid.p_W_m + moved.offset_W_m;
  // First tests a sphere around the solid. A ray that misses the sphere or starts beyond it misses the solid.
  const Eigen::Vector3d to_middle = p_W_m - ray_W.p;
  const double along = to_middle.dot(ray_W.d);
  const double beside_squared = to_middle.squaredNorm() - along * along;
  constexpr double kRounding_m = 1e-6;
  const double radius_m = solid.radius_m + kRounding_m;
  if (along < -radius_m || beside_squared > radius_m * radius_m) return kFar;
  const Eigen::Quaterniond to_solid =
      solid.path.moves() ? (yaw_rotation(moved.turn_rad) * solid.q_W).conjugate() : solid.q_W.conjugate();
  const Ray ray{to_solid * (ray_W.p - p_W_m), to_solid * ray_W.d};
  switch (solid.shape) {
    case scene::Solid::Shape::box:
      return entry_of_box(ray, solid.size_m);
    case scene::Solid::Shape::cylinder:
      return entry_of_cylinder(ray, solid.size_m);
    case scene::Solid::Shape::mesh:
      return entry_of_mesh(ray, *solid.mesh);
  }
  return kFar;
}

}  // namespace

RayCaster::RayCaster(const scene::Scene& scene) : solids_(scene::solids_of(scene)) {}

double RayCaster::distance_m(const Eigen::Vector3d& p_W_m, const Eigen::Vector3d& direction_W, std::int64_t time_ns,
                             const Others& others) const {
  double nearest_m = kFar;
  if (direction_W.z() < 0.0) nearest_m = std::max(0.0, p_W_m.z() / -direction_W.z());
  const Ray ray{p_W_m, direction_W};
  for (const auto& solid : solids_) nearest_m = std::min(nearest_m, entry(solid, time_ns, ray));
  for (std::size_t i = 0; i < others.boxes.size(); ++i) {
    if (i != others.own) nearest_m = std::min(nearest_m, entry(others.boxes[i], time_ns, ray));
  }
  return nearest_m;
}

}  // namespace mebots::world
