// SPDX-License-Identifier: Apache-2.0
#include "speed_course.hpp"

#include "mebots/assert.hpp"

#include <cmath>

namespace mebots::motors {

SpeedCourse::SpeedCourse(const SpeedLaw& law, double initial_rad_per_s, double steady_rad_per_s)
    : quadratic_(law.quadratic_per_rad),
      initial_(initial_rad_per_s),
      steady_(steady_rad_per_s),
      initial_difference_(steady_rad_per_s - initial_rad_per_s),
      rate_(law.linear_per_s + 2 * law.quadratic_per_rad * steady_rad_per_s) {}

double SpeedCourse::decay(double time_s) const {
  MEBOTS_ASSERT(time_s >= 0);
  return rate_ > 0 ? -std::expm1(-rate_ * time_s) / rate_ : time_s;
}

double SpeedCourse::difference(double time_s) const {
  return initial_difference_ * std::exp(-rate_ * time_s) / (1 - quadratic_ * initial_difference_ * decay(time_s));
}

double SpeedCourse::speed(double time_s) const {
  if (initial_difference_ == 0) return initial_;
  return steady_ - difference(time_s);
}

double SpeedCourse::difference_integral(double time_s) const {
  const double straight = initial_difference_ * decay(time_s);
  const double bend = quadratic_ * straight;
  return bend == 0 ? straight : straight * (-std::log1p(-bend) / bend);
}

double SpeedCourse::speed_integral(double time_s) const {
  return steady_ * time_s - difference_integral(time_s);
}

double SpeedCourse::speed_squared_integral(double time_s) const {
  // Integrates w^2 = u^2 - 2 u e + e^2, where the differential equation gives b e^2 = de/dt + k e.
  const double first = difference_integral(time_s);
  const double squared =
      quadratic_ > 0 ? (difference(time_s) - initial_difference_ + rate_ * first) / quadratic_
                     : initial_difference_ * initial_difference_ * -std::expm1(-2 * rate_ * time_s) / (2 * rate_);
  return steady_ * steady_ * time_s - 2 * steady_ * first + squared;
}

double SpeedCourse::time_to(double target_rad_per_s) const {
  const double target_difference = steady_ - target_rad_per_s;
  if (rate_ == 0) return (1 / initial_difference_ - 1 / target_difference) / quadratic_;  // a free rotor
  const double offset = quadratic_ / rate_;
  return std::log((1 / target_difference - offset) / (1 / initial_difference_ - offset)) / rate_;
}

}  // namespace mebots::motors
