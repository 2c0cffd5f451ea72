// SPDX-License-Identifier: Apache-2.0
#include "rotor.hpp"

#include "speed_course.hpp"
#include "support.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::motors {
namespace {

double bench_power_w(const RotorData& rotor, double speed) {
  return rotor.power_per_speed_ws_per_rad * speed +
         rotor.power_per_thrust_w_per_n * rotor.thrust_coefficient * speed * speed;
}

/// Returns the integral of max(0, P) by the trapezoidal rule. P follows from the speed of the closed form.
double numerical_energy_j(const RotorData& rotor, const RotorDrive& drive, double initial, double duration_s) {
  const double u = drive.steady_speed_rad_per_s;
  const SpeedLaw& law = initial > u ? rotor.spin_down : rotor.spin_up;
  const SpeedCourse course(law, initial, u);
  const auto power_w = [&](double t) {
    const double w = course.speed(t);
    const double acceleration = law.linear_per_s * (u - w) + law.quadratic_per_rad * (u * u - w * w);
    return std::max(0.0, bench_power_w(rotor, w) + rotor.inertia_kg_m2 * w * acceleration);
  };
  constexpr int kPieces = 200'000;
  const double h = duration_s / kPieces;
  double sum = (power_w(0) + power_w(duration_s)) / 2;
  for (int i = 1; i < kPieces; ++i) sum += power_w(i * h);
  return sum * h;
}

TEST(Rotor, EnergyIsTheIntegralOfThePowerUpDownAndThroughZero) {
  RotorData rotor = bench_rotor();
  const double k = rotor.thrust_coefficient;
  for (const double inertia_factor : {1.0, 5.0}) {  // while slowing down, the heavy rotor has an interval without power
    rotor.inertia_kg_m2 = 6.983466e-8 * inertia_factor;
    for (const auto& [initial, steady] :
         {std::pair{0.0, 2000.0}, {1900.0, 2000.0}, {2500.0, 2000.0}, {2500.0, 300.0}}) {
      const RotorDrive drive{steady, k, true};
      const double expected_j = numerical_energy_j(rotor, drive, initial, 0.2);
      // The tolerance covers two errors of the trapezoidal rule with steps of h = 1 us: about (k h)^2 / 12 for a decay
      // rate k of the speed, and the error at the time at which the power becomes 0.
      EXPECT_NEAR(advance_rotor(rotor, drive, initial, 0.2).energy_j, expected_j, 1e-8 * std::max(expected_j, 0.1))
          << initial << " to " << steady << ", inertia x " << inertia_factor;
    }
  }
}

TEST(Rotor, TakesNoPowerWhileItsKineticEnergyCoversItsLosses) {
  RotorData rotor = bench_rotor();
  rotor.inertia_kg_m2 *= 5;
  const RotorDrive drive{300, rotor.thrust_coefficient, true};
  EXPECT_EQ(advance_rotor(rotor, drive, 2500, 0.002).energy_j, 0);
}

TEST(Rotor, EnergyBalancesBenchPowerAndKineticEnergy) {
  // While the power is above 0, the input energy is the bench's energy plus the change of kinetic energy.
  const RotorData rotor = bench_rotor();
  double speed = 0;
  double in_j = 0;
  double bench_j = 0;
  for (const double steady : {2200.0, 1900.0, 2300.0}) {
    const RotorDrive drive{steady, rotor.thrust_coefficient, true};
    for (int i = 0; i < 400; ++i) {
      const SpeedLaw& law = speed > steady ? rotor.spin_down : rotor.spin_up;
      const SpeedCourse course(law, speed, steady);
      bench_j += rotor.power_per_speed_ws_per_rad * course.speed_integral(0.002) +
                 rotor.power_per_thrust_w_per_n * rotor.thrust_coefficient * course.speed_squared_integral(0.002);
      const RotorStep step = advance_rotor(rotor, drive, speed, 0.002);
      speed = step.speed_rad_per_s;
      in_j += step.energy_j;
    }
  }
  EXPECT_NEAR(in_j, bench_j + 0.5 * rotor.inertia_kg_m2 * speed * speed, 1e-12 * in_j);
}

TEST(Rotor, ResultDoesNotDependOnTheStep) {
  const RotorData rotor = bench_rotor();
  const RotorDrive drive{2000, rotor.thrust_coefficient, true};
  const RotorStep once = advance_rotor(rotor, drive, 400, 0.1);
  double speed = 400;
  double energy_j = 0;
  for (int i = 0; i < 100; ++i) {
    const RotorStep step = advance_rotor(rotor, drive, speed, 0.001);
    speed = step.speed_rad_per_s;
    energy_j += step.energy_j;
  }
  EXPECT_NEAR(speed, once.speed_rad_per_s, 1e-10 * speed);  // rounding errors of 100 steps
  EXPECT_NEAR(energy_j, once.energy_j, 1e-10 * energy_j);
}

TEST(Rotor, InertiaIsThatOfARotorSlowedByItsDragTorque) {
  // The file's inertia must be the quotient of two coefficients: drag torque per speed squared, and deceleration per
  // speed squared.
  const RotorData rotor = bench_rotor();
  EXPECT_NEAR(rotor.inertia_kg_m2,
              rotor.torque_per_thrust_m * rotor.thrust_coefficient / rotor.spin_down.quadratic_per_rad,
              1e-6 * rotor.inertia_kg_m2);
}

TEST(Rotor, SwitchedOffTakesNoEnergyAndSlowsDown) {
  const RotorData rotor = bench_rotor();
  const RotorStep step = advance_rotor(rotor, {0, rotor.thrust_coefficient, false}, 2000, 0.5);
  EXPECT_EQ(step.energy_j, 0);
  EXPECT_LT(step.speed_rad_per_s, 700);
  EXPECT_GT(step.speed_rad_per_s, 0);
}

}  // namespace
}  // namespace mebots::motors
