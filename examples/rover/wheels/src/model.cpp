// SPDX-License-Identifier: Apache-2.0
#include "model.hpp"

#include <cmath>

namespace mebots::rover_wheels {

double Model::Wheel::step(double command_m_per_s, double duration_s, double lag_s) {
  const double missing_m_per_s = command_m_per_s - speed_m_per_s;
  const double share = -std::expm1(-duration_s / lag_s);
  const double rolled_m = command_m_per_s * duration_s - missing_m_per_s * lag_s * share;
  speed_m_per_s += share * missing_m_per_s;
  way_m += rolled_m;
  return rolled_m;
}

void Model::Wheel::visit(state::Visitor& v) {
  v("speed_m_per_s", speed_m_per_s);
  v("way_m", way_m);
}

Model::Model(const Parameters& parameters, const std::filesystem::path& /*resources*/) : parameters_(parameters) {}

void Model::start(const Inputs& /*inputs*/, Outputs& outputs) {
  write(outputs);
}

void Model::step(const Inputs& inputs, std::int64_t duration_ns, Outputs& outputs) {
  const double duration_s = 1e-9 * static_cast<double>(duration_ns);
  const auto& p = parameters_;
  const double left_m = left_.step(inputs.wheels_left_speed_m_per_s, duration_s, p.wheels_lag_s);
  const double right_m =
      p.wheels_right_factor * right_.step(inputs.wheels_right_speed_m_per_s, duration_s, p.wheels_lag_s);
  const double turn_rad = (right_m - left_m) / p.wheels_track_m;
  const double along_m = 0.5 * (left_m + right_m);
  x_m_ += along_m * std::cos(yaw_rad_ + 0.5 * turn_rad);
  y_m_ += along_m * std::sin(yaw_rad_ + 0.5 * turn_rad);
  yaw_rad_ += turn_rad;
  write(outputs);
}

void Model::write(Outputs& outputs) const {
  const double left_m_per_s = left_.speed_m_per_s;
  const double right_m_per_s = parameters_.wheels_right_factor * right_.speed_m_per_s;
  const double speed_m_per_s = 0.5 * (left_m_per_s + right_m_per_s);
  outputs.wheels_left_way_m = left_.way_m;
  outputs.wheels_right_way_m = right_.way_m;
  outputs.position_x_m = x_m_;
  outputs.position_y_m = y_m_;
  outputs.velocity_x_m_per_s = speed_m_per_s * std::cos(yaw_rad_);
  outputs.velocity_y_m_per_s = speed_m_per_s * std::sin(yaw_rad_);
  outputs.yaw_rad = yaw_rad_;
  outputs.yaw_rate_rad_per_s = (right_m_per_s - left_m_per_s) / parameters_.wheels_track_m;
}

void Model::visit(state::Visitor& v) {
  v("left", left_);
  v("right", right_);
  v("x_m", x_m_);
  v("y_m", y_m_);
  v("yaw_rad", yaw_rad_);
}

}  // namespace mebots::rover_wheels
