// SPDX-License-Identifier: Apache-2.0
#include "sensors/imu.hpp"

#include "dynamics/rigid_world.hpp"
#include "math/periods.hpp"
#include "mebots/error.hpp"
#include "noise/counter_noise.hpp"

#include <fmt/format.h>

#include <cmath>

namespace mebots::world {
namespace {

constexpr int kAxes = 6;  // three of each

}  // namespace

Imu::Imu(const Settings& settings, std::uint64_t seed) : settings_(settings), seed_(seed) {
  const auto require = [](double value, const char* name) {
    if (!(value >= 0.0) || !std::isfinite(value)) {
      throw Error(fmt::format("{} = {} must be a finite number >= 0", name, value));
    }
  };
  require(settings.acceleration_noise_m_per_s2, "imu.acceleration_noise");
  require(settings.acceleration_bias_m_per_s2, "imu.acceleration_bias");
  require(settings.rate_noise_rad_per_s, "imu.rate_noise");
  require(settings.rate_bias_rad_per_s, "imu.rate_bias");
}

Eigen::Vector3d Imu::disturbed(const Eigen::Vector3d& truth, double noise, double bias, int first,
                               std::int64_t sample) const {
  Eigen::Vector3d reading = truth;
  for (int axis = 0; axis < 3; ++axis) {
    const auto of_axis = static_cast<std::uint64_t>(first) + static_cast<std::uint64_t>(axis);
    if (bias > 0.0) reading[axis] += bias * noise::gaussian(seed_, noise::Stream::imu_bias, of_axis);
    if (noise > 0.0)
      reading[axis] +=
          noise * noise::gaussian(seed_, noise::Stream::imu, kAxes * static_cast<std::uint64_t>(sample) + of_axis);
  }
  return reading;
}

void Imu::update(std::int64_t time_ns, const RigidState& from, const RigidState& to, double dt_s) {
  const std::int64_t due = period_at(time_ns, kPeriod_ns);
  if (due == sample_) return;
  sample_ = due;
  const Eigen::Vector3d gravity_W{0.0, 0.0, -kGravity_m_per_s2};
  const Eigen::Vector3d force_W = (to.v_WB_m_per_s - from.v_WB_m_per_s) / dt_s - gravity_W;
  acceleration_m_per_s2_ = disturbed(to.q_WB.conjugate() * force_W, settings_.acceleration_noise_m_per_s2,
                                     settings_.acceleration_bias_m_per_s2, 0, due);
  rate_rad_per_s_ =
      disturbed(to.body_rate_rad_per_s(), settings_.rate_noise_rad_per_s, settings_.rate_bias_rad_per_s, 3, due);
}

void Imu::visit(state::Visitor& v) {
  v("sample", sample_);
  v("acceleration_m_per_s2", numbers(acceleration_m_per_s2_));
  v("rate_rad_per_s", numbers(rate_rad_per_s_));
}

}  // namespace mebots::world
