// SPDX-License-Identifier: Apache-2.0
#include "sensors/magnetometer.hpp"

#include "math/eigen_state.hpp"
#include "math/rounding.hpp"
#include "noise/counter_noise.hpp"

#include <algorithm>

namespace mebots::world {

Magnetometer::Magnetometer(const scene::MagnetometerData& data, const Eigen::Vector3d& field_W_t, std::uint64_t seed)
    : data_(data), field_W_t_(field_W_t), clock_(data.period_s), seed_(seed) {}

void Magnetometer::update(std::int64_t time_ns, const Eigen::Quaterniond& q_WB) {
  if (!clock_.advance(time_ns)) return;
  const Eigen::Vector3d truth_B_t = q_WB.conjugate() * field_W_t_;
  for (int axis = 0; axis < 3; ++axis) {
    const auto of_axis = static_cast<std::uint64_t>(axis);
    const double bias_t = data_.bias_t * noise::gaussian(seed_, noise::Stream::magnetometer_bias, of_axis);
    const double noise_t =
        data_.noise_t[axis] * noise::gaussian(seed_, noise::Stream::magnetometer, 3 * clock_.number() + of_axis);
    const double reading_t = rounded(truth_B_t[axis] + bias_t + noise_t, data_.resolution_t);
    field_B_t_[axis] = std::clamp(reading_t, -data_.limit_t, data_.limit_t);
  }
}

void Magnetometer::visit(state::Visitor& v) {
  v("clock", clock_);
  v("field_B_t", numbers(field_B_t_));
}

}  // namespace mebots::world
