// SPDX-License-Identifier: Apache-2.0
// Compares the closed form with numerical integration of the same equation.
#include "speed_course.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace mebots::motors {
namespace {

/// Returns w, the integral of w and the integral of w^2 by the classical Runge-Kutta method.
std::array<double, 3> integrate(const SpeedLaw& law, double initial, double steady, double time_s, int steps) {
  using State = std::array<double, 3>;
  const auto rate = [&](const State& y) -> State {
    return {law.linear_per_s * (steady - y[0]) + law.quadratic_per_rad * (steady * steady - y[0] * y[0]), y[0],
            y[0] * y[0]};
  };
  const auto plus = [](State y, const State& k, double h) {
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += h * k[i];
    return y;
  };
  State y{initial, 0, 0};
  const double h = time_s / steps;
  for (int n = 0; n < steps; ++n) {
    const State k1 = rate(y);
    const State k2 = rate(plus(y, k1, h / 2));
    const State k3 = rate(plus(y, k2, h / 2));
    const State k4 = rate(plus(y, k3, h));
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
  }
  return y;
}

constexpr SpeedLaw kLinear{7.36, 0};
constexpr SpeedLaw kQuadratic{0, 2.33e-3};
constexpr SpeedLaw kBoth{5.17, 7.8e-4};

TEST(SpeedCourse, AgreesWithNumericalIntegrationUpAndDown) {
  for (const SpeedLaw& law : {kLinear, kQuadratic, kBoth}) {
    for (const auto& [initial, steady] : {std::pair{0.0, 2000.0}, {1500.0, 2000.0}, {2500.0, 800.0}, {2500.0, 0.0}}) {
      const double time_s = 0.3;
      const SpeedCourse course(law, initial, steady);
      const auto expected = integrate(law, initial, steady, time_s, 3000);
      // The decay rate of the speed times the step is about 1e-3. Therefore the error of the Runge-Kutta method is
      // about the rounding error.
      EXPECT_NEAR(course.speed(time_s), expected[0], 1e-9 * 2500);
      EXPECT_NEAR(course.speed_integral(time_s), expected[1], 1e-9 * 2500 * time_s);
      EXPECT_NEAR(course.speed_squared_integral(time_s), expected[2], 1e-9 * 2500 * 2500 * time_s);
    }
  }
}

TEST(SpeedCourse, TwoHalvesMakeTheWhole) {
  const SpeedCourse whole(kBoth, 300, 2100);
  const SpeedCourse second(kBoth, whole.speed(0.05), 2100);
  EXPECT_NEAR(second.speed(0.05), whole.speed(0.1), 1e-11 * 2100);
  EXPECT_NEAR(whole.speed_squared_integral(0.05) + second.speed_squared_integral(0.05),
              whole.speed_squared_integral(0.1), 1e-11 * 2100 * 2100 * 0.1);
}

TEST(SpeedCourse, NeverPassesTheSteadySpeed) {
  for (const SpeedLaw& law : {kLinear, kQuadratic, kBoth}) {
    EXPECT_LE(SpeedCourse(law, 0, 2000).speed(100), 2000);
    EXPECT_GE(SpeedCourse(law, 2500, 2000).speed(100), 2000);
    EXPECT_NEAR(SpeedCourse(law, 0, 2000).speed(100), 2000, 1e-9);
  }
}

TEST(SpeedCourse, AtTheSteadySpeedNothingMoves) {
  const SpeedCourse course(kBoth, 1234.5, 1234.5);
  EXPECT_EQ(course.speed(0.7), 1234.5);
  EXPECT_NEAR(course.speed_squared_integral(0.7), 1234.5 * 1234.5 * 0.7, 1e-9);
}

TEST(SpeedCourse, FreeRotorUnderDragAloneFallsAsOneOverTime) {
  const SpeedCourse course(kQuadratic, 2000, 0);
  EXPECT_NEAR(course.speed(0.4), 2000 / (1 + 2.33e-3 * 2000 * 0.4), 1e-10);
}

TEST(SpeedCourse, TimeToASpeedIsWhenItIsReached) {
  for (const SpeedLaw& law : {kLinear, kQuadratic, kBoth}) {
    const SpeedCourse down(law, 2400, 900);
    EXPECT_NEAR(down.speed(down.time_to(1300)), 1300, 1e-9);
    const SpeedCourse up(law, 100, 900);
    EXPECT_NEAR(up.speed(up.time_to(700)), 700, 1e-9);
  }
  const SpeedCourse free(kQuadratic, 2000, 0);
  EXPECT_NEAR(free.speed(free.time_to(500)), 500, 1e-9);
}

}  // namespace
}  // namespace mebots::motors
