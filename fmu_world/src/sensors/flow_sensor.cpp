// SPDX-License-Identifier: Apache-2.0
#include "sensors/flow_sensor.hpp"

#include "math/periods.hpp"
#include "noise/counter_noise.hpp"

#include <cmath>

namespace mebots::world {

FlowSensor::FlowSensor(const scene::FlowData& data, std::uint64_t seed, std::int64_t start_ns)
    : data_(data), period_ns_(std::llround(data.period_s * 1e9)), seed_(seed) {
  sample_.number = period_at(start_ns, period_ns_);
}

void FlowSensor::update(std::int64_t time_ns, const RigidState& state, double distance_m, double dt_s) {
  const Eigen::Vector3d v_B = state.q_WB.conjugate() * state.v_WB_m_per_s;
  const Eigen::Vector3d w_B = state.body_rate_rad_per_s();
  gathered_s_ += dt_s;
  if (std::isfinite(distance_m) && distance_m >= data_.nearest_m) {
    const std::array<double, 2> flow_rad_per_s{v_B.x() / distance_m - w_B.y(), v_B.y() / distance_m + w_B.x()};
    for (std::size_t i = 0; i < 2; ++i) {
      hidden_ = hidden_ || !(std::abs(flow_rad_per_s[i]) <= data_.fastest_rad_per_s);  // 0 / 0 also counts as invisible
      moved_pixels_[i] += dt_s * data_.pixels_per_rad * flow_rad_per_s[i];
    }
  } else {
    hidden_ = true;
  }
  const std::int64_t due = period_at(time_ns, period_ns_);
  if (due == sample_.number) return;
  sample_.number = due;
  sample_.seen = !hidden_;
  sample_.period_s = gathered_s_;
  for (std::size_t i = 0; i < 2; ++i) {
    if (hidden_) {
      sample_.counts[i] = 0;
      moved_pixels_[i] = 0.0;
      continue;
    }
    const std::uint64_t index = 2 * static_cast<std::uint64_t>(due) + i;
    const double read_pixels =
        moved_pixels_[i] + data_.noise_pixels * noise::gaussian(seed_, noise::Stream::flow, index);
    sample_.counts[i] = static_cast<std::int32_t>(std::lround(read_pixels / data_.resolution_pixels));
    moved_pixels_[i] = read_pixels - sample_.counts[i] * data_.resolution_pixels;
  }
  gathered_s_ = 0.0;
  hidden_ = false;
}

void FlowSensor::visit(state::Visitor& v) {
  v("number", sample_.number);
  v("counts", sample_.counts);
  v("seen", sample_.seen);
  v("period_s", sample_.period_s);
  v("moved_pixels", moved_pixels_);
  v("gathered_s", gathered_s_);
  v("hidden", hidden_);
}

}  // namespace mebots::world
