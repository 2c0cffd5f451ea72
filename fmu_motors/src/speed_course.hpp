// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "rotor_data.hpp"

namespace mebots::motors {

/// Computes the speed w of a rotor over time at a constant steady speed u:
/// dw/dt = a (u - w) + b (u^2 - w^2)
/// With e = u - w, this is Bernoulli's equation de/dt = -k e + b e^2 with k = a + 2 b u. Its solution has a
/// closed form.
class SpeedCourse {
 public:
  /// Creates the course from the speed `initial` towards the speed `steady` [rad/s, both >= 0]. `law` has the
  /// coefficients a and b, which must be >= 0.
  SpeedCourse(const SpeedLaw& law, double initial_rad_per_s, double steady_rad_per_s);

  /// Returns the speed [rad/s] after `time_s` >= 0.
  double speed(double time_s) const;
  /// Returns the integral of w [rad] over the first `time_s`.
  double speed_integral(double time_s) const;
  /// Returns the integral of w^2 [rad^2/s] over the first `time_s`.
  double speed_squared_integral(double time_s) const;
  /// Returns the time [s] until the speed is `target`, which must be between the initial and the steady speed, and not
  /// equal to the steady speed.
  double time_to(double target_rad_per_s) const;

 private:
  double decay(double time_s) const;       // (1 - exp(-k t)) / k
  double difference(double time_s) const;  // e(t)
  double difference_integral(double time_s) const;

  double quadratic_;
  double initial_;
  double steady_;
  double initial_difference_;
  double rate_;  // k
};

}  // namespace mebots::motors
