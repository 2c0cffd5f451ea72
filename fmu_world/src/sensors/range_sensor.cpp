// SPDX-License-Identifier: Apache-2.0
#include "sensors/range_sensor.hpp"

#include "math/periods.hpp"
#include "math/rotation.hpp"
#include "mebots/assert.hpp"
#include "mebots/error.hpp"
#include "noise/counter_noise.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace mebots::world {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// A ray p + t d, t >= 0.
struct Ray {
  Eigen::Vector3d p;
  Eigen::Vector3d d;
};

/// Returns the distance at which the ray enters the box; infinity if it misses the box or starts inside.
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

/// Returns the distance at which the ray enters a cylinder along z: |p + t d| = r in x and y, |z| at most half its
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

/// Returns the distance of the nearest triangle whose front the ray meets (Moeller and Trumbore 1997).
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
  // Tests a sphere around the solid first: if the ray misses the sphere or starts beyond it, it misses the solid.
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

/// Returns rays of a cone: its axis, and eight rays each at half the cone's angle and on its edge.
std::vector<Eigen::Vector3d> rays_of_cone(double half_angle_rad) {
  std::vector<Eigen::Vector3d> rays{-Eigen::Vector3d::UnitZ()};
  constexpr int kAround = 8;
  for (const double angle : {0.5 * half_angle_rad, half_angle_rad}) {
    for (int i = 0; i < kAround; ++i) {
      const double turn = 2.0 * std::numbers::pi * i / kAround;
      rays.emplace_back(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), -std::cos(angle));
    }
  }
  return rays;
}

double cone_noise_m(const scene::RangeData& cone, double distance_m) {
  const double per_m = std::log(cone.far_noise_m / cone.near_noise_m) / (cone.far_m - cone.near_m);
  return cone.near_noise_m * (1.0 + std::exp(per_m * (distance_m - cone.near_m)));
}

}  // namespace

RangeSensor::RangeSensor(const scene::Scene& scene, const scene::Drone& drone, const Settings& settings,
                         std::uint64_t seed)
    : solids_(scene::solids_of(scene)), limit_m_(drone.range_limit_m), noise_m_(settings.noise_m), seed_(seed) {
  if (settings.model == RangeModel::ray) return;
  if (!drone.range) {
    throw Error(fmt::format("range.model = cone needs range_sensor in the drone file of \"{}\"; add it or use ray",
                            drone.name));
  }
  cone_ = drone.range;
  period_ns_ = std::llround(cone_->period_s * 1e9);
  rays_B_ = rays_of_cone(0.5 * cone_->field_of_view_rad);
}

double RangeSensor::along_m(const RigidState& state, const Eigen::Vector3d& direction_B, std::int64_t time_ns,
                            const Others& others) const {
  const Eigen::Vector3d direction_W = state.q_WB * direction_B;
  double nearest_m = kFar;
  if (direction_W.z() < 0.0) nearest_m = std::max(0.0, state.p_WB_m.z() / -direction_W.z());
  const Ray ray{state.p_WB_m, direction_W};
  for (const auto& solid : solids_) nearest_m = std::min(nearest_m, entry(solid, time_ns, ray));
  for (std::size_t i = 0; i < others.boxes.size(); ++i) {
    if (i != others.own) nearest_m = std::min(nearest_m, entry(others.boxes[i], time_ns, ray));
  }
  return nearest_m;
}

double RangeSensor::sight_m(const RigidState& state, std::int64_t time_ns, const Others& others) const {
  return along_m(state, -Eigen::Vector3d::UnitZ(), time_ns, others);
}

double RangeSensor::distance_m(const RigidState& state, std::int64_t time_ns, const Others& others) const {
  MEBOTS_ASSERT(limit_m_ > 0);
  return std::min(limit_m_, sight_m(state, time_ns, others));
}

double RangeSensor::nearest_in_cone_m(const RigidState& state, std::int64_t time_ns, const Others& others) const {
  double nearest_m = limit_m_;
  for (const auto& ray_B : rays_B_) nearest_m = std::min(nearest_m, along_m(state, ray_B, time_ns, others));
  return nearest_m;
}

void RangeSensor::update(std::int64_t time_ns, const RigidState& state, const Others& others) {
  const std::int64_t due = period_at(time_ns, period_ns_);
  if (due == sample_) return;
  sample_ = due;
  const double truth_m = cone_ ? nearest_in_cone_m(state, time_ns, others) : distance_m(state, time_ns, others);
  if (cone_ && truth_m >= limit_m_) {
    reading_m_ = limit_m_;
    return;
  }
  const double noise_m = (cone_ ? cone_noise_m(*cone_, truth_m) : noise_m_) *
                         noise::gaussian(seed_, noise::Stream::range, static_cast<std::uint64_t>(due));
  reading_m_ = std::max(0.0, truth_m + noise_m);
  if (cone_ && cone_->resolution_m > 0.0) {
    reading_m_ = cone_->resolution_m * std::round(reading_m_ / cone_->resolution_m);
  }
}

void RangeSensor::visit(state::Visitor& v) {
  v("sample", sample_);
  v("reading_m", reading_m_);
}

}  // namespace mebots::world
