// SPDX-License-Identifier: Apache-2.0
#include "sensors/range_sensor.hpp"

#include "math/rotation.hpp"
#include "mebots/assert.hpp"
#include "noise/counter_noise.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace mebots::world {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// Where the ray p + t d, t >= 0, enters the box; infinity when it passes by or starts inside.
double entry(const scene::Box& box, const Eigen::Vector3d& p_W, const Eigen::Vector3d& d_W) {
  const Eigen::Quaterniond to_box = yaw_rotation(-box.yaw_rad);
  const Eigen::Vector3d p = to_box * (p_W - box.p_W_m);
  const Eigen::Vector3d d = to_box * d_W;
  double enter = 0.0;
  double leave = kFar;
  for (int axis = 0; axis < 3; ++axis) {
    const double half = 0.5 * box.size_m[axis];
    if (d[axis] == 0.0) {
      if (p[axis] < -half || p[axis] > half) return kFar;
      continue;
    }
    double near = (-half - p[axis]) / d[axis];
    double far = (half - p[axis]) / d[axis];
    if (near > far) std::swap(near, far);
    enter = std::max(enter, near);
    leave = std::min(leave, far);
  }
  return enter > 0.0 && enter <= leave ? enter : kFar;
}

}  // namespace

RangeSensor::RangeSensor(const scene::Scene& scene, double noise_m, std::uint64_t seed)
    : boxes_(scene.boxes), limit_m_(scene.drone.range_limit_m), noise_m_(noise_m), seed_(seed) {
  for (const auto& gate : scene.gates) {
    for (const auto& beam : gate.beams()) boxes_.push_back(beam);
  }
}

double RangeSensor::distance_m(const RigidState& state) const {
  const Eigen::Vector3d down_W = -(state.q_WB * Eigen::Vector3d::UnitZ());
  double nearest_m = limit_m_;
  MEBOTS_ASSERT(limit_m_ > 0);
  if (down_W.z() < 0.0) nearest_m = std::min(nearest_m, std::max(0.0, state.p_WB_m.z() / -down_W.z()));
  for (const auto& box : boxes_) nearest_m = std::min(nearest_m, entry(box, state.p_WB_m, down_W));
  return nearest_m;
}

void RangeSensor::update(std::int64_t time_ns, const RigidState& state) {
  const std::int64_t due = time_ns / kPeriod_ns;
  if (due == sample_) return;
  sample_ = due;
  const double noise_m = noise_m_ * noise::gaussian(seed_, noise::Stream::range, static_cast<std::uint64_t>(due));
  reading_m_ = std::max(0.0, distance_m(state) + noise_m);
}

void RangeSensor::visit(state::Visitor& v) {
  v("sample", sample_);
  v("reading_m", reading_m_);
}

}  // namespace mebots::world
