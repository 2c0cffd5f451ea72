// SPDX-License-Identifier: Apache-2.0
#include "sensors/multiranger.hpp"

#include "noise/counter_noise.hpp"

#include <cstddef>
#include <utility>

namespace mebots::world {
namespace {

Eigen::Vector3d unit_vector(std::size_t beam) {
  switch (beam) {
    case direction::front:
      return Eigen::Vector3d::UnitX();
    case direction::back:
      return -Eigen::Vector3d::UnitX();
    case direction::left:
      return Eigen::Vector3d::UnitY();
    case direction::right:
      return -Eigen::Vector3d::UnitY();
    default:
      return Eigen::Vector3d::UnitZ();
  }
}

}  // namespace

Multiranger::Multiranger(std::shared_ptr<const RayCaster> rays, const scene::Drone& drone,
                         const scene::MultirangerData& data, const Ranging::Settings& settings, std::uint64_t seed)
    : ranging_(std::move(rays), drone, settings), clock_(data.period_s), seed_(seed) {
  for (std::size_t i = 0; i < beams_.size(); ++i) {
    const Eigen::Vector3d direction_B = unit_vector(i);
    beams_[i] = {direction_B.cwiseProduct(data.offset_m), ranging_.rays_around(direction_B)};
  }
}

void Multiranger::update(std::int64_t time_ns, const RigidState& state, const Others& others) {
  if (!clock_.advance(time_ns)) return;
  for (std::size_t i = 0; i < beams_.size(); ++i) {
    const Eigen::Vector3d origin_W_m = state.p_WB_m + state.q_WB * beams_[i].origin_B_m;
    const double distance_m = ranging_.nearest_m(origin_W_m, state.q_WB, beams_[i].rays_B, time_ns, others);
    const std::uint64_t index = direction::kCount * clock_.number() + i;
    readings_m_[i] = ranging_.reading_m(distance_m, noise::gaussian(seed_, noise::Stream::multiranger, index));
  }
}

void Multiranger::visit(state::Visitor& v) {
  v("clock", clock_);
  v("readings_m", readings_m_);
}

}  // namespace mebots::world
