// SPDX-License-Identifier: Apache-2.0
#include "sensors/range_sensor.hpp"

#include "math/periods.hpp"
#include "mebots/assert.hpp"
#include "noise/counter_noise.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mebots::world {

RangeSensor::RangeSensor(std::shared_ptr<const RayCaster> rays, const scene::Drone& drone, const Settings& settings,
                         std::uint64_t seed)
    : ranging_(std::move(rays), drone, settings),
      rays_B_(ranging_.rays_around(-Eigen::Vector3d::UnitZ())),
      seed_(seed) {
  if (ranging_.cone()) period_ns_ = std::llround(ranging_.cone()->period_s * 1e9);
}

double RangeSensor::sight_m(const RigidState& state, std::int64_t time_ns, const Others& others) const {
  return ranging_.rays().distance_m(state.p_WB_m, state.q_WB * -Eigen::Vector3d::UnitZ(), time_ns, others);
}

double RangeSensor::distance_m(const RigidState& state, std::int64_t time_ns, const Others& others) const {
  MEBOTS_ASSERT(limit_m() > 0);
  return std::min(limit_m(), sight_m(state, time_ns, others));
}

void RangeSensor::update(std::int64_t time_ns, const RigidState& state, const Others& others) {
  const std::int64_t due = period_at(time_ns, period_ns_);
  if (due == sample_) return;
  sample_ = due;
  const double distance_m = ranging_.nearest_m(state.p_WB_m, state.q_WB, rays_B_, time_ns, others);
  reading_m_ =
      ranging_.reading_m(distance_m, noise::gaussian(seed_, noise::Stream::range, static_cast<std::uint64_t>(due)));
}

void RangeSensor::visit(state::Visitor& v) {
  v("sample", sample_);
  v("reading_m", reading_m_);
}

}  // namespace mebots::world
