// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::world::crazyflie {

/// The gains of the controller kp e + ki integral(e) - kd d(measured)/dt of the Crazyflie's firmware.
struct PidGains {
  double kp = 0.0;
  double ki = 0.0;
  double kd = 0.0;
  double integral_limit = 5000.0;  ///< limit of integral(e); the firmware's default
  double output_limit = 0.0;       ///< 0: no limit
  bool wraps = false;              ///< true if the controlled quantity is an angle in degrees
};

class Pid {
 public:
  explicit Pid(const PidGains& gains) : gains_(gains) {}

  void reset(double measured) {
    integral_ = 0.0;
    measured_ = measured;
  }

  double update(double desired, double measured, double dt_s) {
    const double error = shortest(desired - measured);
    const double rate = shortest(measured - measured_) / dt_s;
    measured_ = measured;
    integral_ = std::clamp(integral_ + error * dt_s, -gains_.integral_limit, gains_.integral_limit);
    const double output = gains_.kp * error + gains_.ki * integral_ - gains_.kd * rate;
    return gains_.output_limit > 0.0 ? std::clamp(output, -gains_.output_limit, gains_.output_limit) : output;
  }

  void visit(state::Visitor& v) {
    v("integral", integral_);
    v("measured", measured_);
  }

 private:
  double shortest(double difference) const { return gains_.wraps ? std::remainder(difference, 360.0) : difference; }

  PidGains gains_;
  double integral_ = 0.0;
  double measured_ = 0.0;
};

}  // namespace mebots::world::crazyflie
