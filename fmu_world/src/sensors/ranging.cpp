// SPDX-License-Identifier: Apache-2.0
#include "sensors/ranging.hpp"

#include "math/rounding.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace mebots::world {
namespace {

/// Returns the rays of a cone around -z: its axis, eight rays at half the cone's angle, and eight rays on its edge.
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

Ranging::Ranging(std::shared_ptr<const RayCaster> rays, const scene::Drone& drone, const Settings& settings)
    : rays_(std::move(rays)), limit_m_(drone.range_limit_m), noise_m_(settings.noise_m) {
  if (settings.model == RangeModel::ray) return;
  if (!drone.range) {
    throw Error(fmt::format("range.model = cone needs range_sensor in the drone file of \"{}\"; add it or use ray",
                            drone.name));
  }
  cone_ = drone.range;
}

std::vector<Eigen::Vector3d> Ranging::rays_around(const Eigen::Vector3d& direction_B) const {
  if (!cone_) return {direction_B};
  std::vector<Eigen::Vector3d> rays_B = rays_of_cone(0.5 * cone_->field_of_view_rad);
  if (direction_B == -Eigen::Vector3d::UnitZ()) return rays_B;
  if (direction_B == Eigen::Vector3d::UnitZ()) {  // FromTwoVectors() has no defined axis for opposite vectors
    for (Eigen::Vector3d& ray_B : rays_B) ray_B.z() = -ray_B.z();
    return rays_B;
  }
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(-Eigen::Vector3d::UnitZ(), direction_B);
  for (Eigen::Vector3d& ray_B : rays_B) ray_B = turn * ray_B;
  return rays_B;
}

double Ranging::nearest_m(const Eigen::Vector3d& p_W_m, const Eigen::Quaterniond& q_WB,
                          std::span<const Eigen::Vector3d> rays_B, std::int64_t time_ns, const Others& others) const {
  double nearest_m = limit_m_;
  for (const auto& ray_B : rays_B) {
    nearest_m = std::min(nearest_m, rays_->distance_m(p_W_m, q_WB * ray_B, time_ns, others));
  }
  return nearest_m;
}

double Ranging::reading_m(double distance_m, double gaussian) const {
  if (cone_ && distance_m >= limit_m_) return limit_m_;
  const double noise_m = (cone_ ? cone_noise_m(*cone_, distance_m) : noise_m_) * gaussian;
  return rounded(std::max(0.0, distance_m + noise_m), cone_ ? cone_->resolution_m : 0.0);
}

}  // namespace mebots::world
