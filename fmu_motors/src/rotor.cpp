// SPDX-License-Identifier: Apache-2.0
#include "rotor.hpp"

#include "mebots/assert.hpp"
#include "speed_course.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::motors {
namespace {

/// Returns the speed above which the power of a decelerating rotor is negative. At speed w and steady speed u, power /
/// w = a + b k w + J (u - w) (linear + quadratic (u + w)). The result is the positive root of this parabola.
double speed_of_zero_power(const RotorData& rotor, const RotorDrive& drive, const SpeedLaw& law) {
  const double u = drive.steady_speed_rad_per_s;
  const double square = rotor.inertia_kg_m2 * law.quadratic_per_rad;  // coefficient of -w^2
  const double linear =
      rotor.power_per_thrust_w_per_n * drive.thrust_coefficient - rotor.inertia_kg_m2 * law.linear_per_s;
  const double constant =
      rotor.power_per_speed_ws_per_rad + rotor.inertia_kg_m2 * (law.linear_per_s * u + law.quadratic_per_rad * u * u);
  const double root = std::sqrt(linear * linear + 4 * square * constant);
  if (linear < 0) return 2 * constant / (root - linear);
  return square > 0 ? (linear + root) / (2 * square) : HUGE_VAL;
}

double energy_j(const RotorData& rotor, const RotorDrive& drive, const SpeedCourse& course, double from_speed,
                double to_speed, double duration_s) {
  const double energy =
      rotor.power_per_speed_ws_per_rad * course.speed_integral(duration_s) +
      rotor.power_per_thrust_w_per_n * drive.thrust_coefficient * course.speed_squared_integral(duration_s) +
      0.5 * rotor.inertia_kg_m2 * (to_speed - from_speed) * (to_speed + from_speed);
  return std::max(energy, 0.0);  // rounding may make the integral negative
}

}  // namespace

RotorStep advance_rotor(const RotorData& rotor, const RotorDrive& drive, double speed_rad_per_s, double duration_s) {
  const bool slowing = speed_rad_per_s > drive.steady_speed_rad_per_s;
  MEBOTS_ASSERT(speed_rad_per_s >= 0 && drive.steady_speed_rad_per_s >= 0 && duration_s > 0);
  const SpeedLaw& law = slowing ? rotor.spin_down : rotor.spin_up;
  const SpeedCourse course(law, speed_rad_per_s, drive.steady_speed_rad_per_s);
  // Rounding may make the closed form slightly negative.
  const double end = std::max(course.speed(duration_s), 0.0);
  if (!drive.driven) return {end, 0, 0};

  const double powered_below = slowing ? speed_of_zero_power(rotor, drive, law) : HUGE_VAL;
  if (speed_rad_per_s <= powered_below) {
    return {end, energy_j(rotor, drive, course, speed_rad_per_s, end, duration_s), 0};
  }
  if (end >= powered_below) return {end, 0, 0};
  const double unpowered_s = std::min(course.time_to(powered_below), duration_s);
  const SpeedCourse rest(law, powered_below, drive.steady_speed_rad_per_s);
  return {end, energy_j(rotor, drive, rest, powered_below, end, duration_s - unpowered_s), 0};
}

}  // namespace mebots::motors
