// SPDX-License-Identifier: Apache-2.0
#include "sensors/contact_sensor.hpp"

#include "math/eigen_state.hpp"
#include "noise/counter_noise.hpp"

#include <utility>

namespace mebots::world {

ContactSensor::ContactSensor(double period_s, double noise_n, std::uint64_t seed)
    : noise_n_(noise_n), clock_(period_s), seed_(seed) {}

void ContactSensor::update(std::int64_t time_ns, bool touches, const Eigen::Vector3d& force_B_n, double dt_s) {
  touched_ = touched_ || touches;
  impulse_B_n_s_ += dt_s * force_B_n;
  gathered_s_ += dt_s;
  if (!clock_.advance(time_ns)) return;
  touching_ = std::exchange(touched_, false);
  force_B_n_ = impulse_B_n_s_ / gathered_s_;
  for (int axis = 0; axis < 3 && noise_n_ > 0.0; ++axis) {
    const std::uint64_t index = 3 * clock_.number() + static_cast<std::uint64_t>(axis);
    force_B_n_[axis] += noise_n_ * noise::gaussian(seed_, noise::Stream::contact, index);
  }
  impulse_B_n_s_.setZero();
  gathered_s_ = 0.0;
}

void ContactSensor::visit(state::Visitor& v) {
  v("clock", clock_);
  v("touched", touched_);
  v("impulse_B_n_s", numbers(impulse_B_n_s_));
  v("gathered_s", gathered_s_);
  v("touching", touching_);
  v("force_B_n", numbers(force_B_n_));
}

}  // namespace mebots::world
