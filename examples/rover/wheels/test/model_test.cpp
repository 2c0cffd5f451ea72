// SPDX-License-Identifier: Apache-2.0
#include "model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

namespace mebots::rover_wheels {
namespace {

struct Bench {
  explicit Bench(double right_factor) {
    parameters.wheels_right_factor = right_factor;
    model.emplace(parameters, ".");
    model->start(inputs, outputs);
  }

  void run(double seconds, int steps) {
    for (int i = 0; i < steps; ++i) model->step(inputs, std::llround(1e9 * seconds / steps), outputs);
  }

  Parameters parameters;
  Inputs inputs;
  Outputs outputs;
  std::optional<Model> model;
};

TEST(RoverWheels, ARoverDrivesStraightAfterItsLag) {
  Bench bench(1.0);
  bench.inputs.wheels_left_speed_m_per_s = bench.inputs.wheels_right_speed_m_per_s = 0.5;
  bench.run(2.0, 8);
  // By hand: x = c (t - lag (1 - exp(-t / lag))).
  EXPECT_NEAR(bench.outputs.position_x_m, 0.5 * (2.0 - 0.1 * (1.0 - std::exp(-20.0))), 1e-12);
  EXPECT_EQ(bench.outputs.position_y_m, 0.0);
  EXPECT_NEAR(bench.outputs.velocity_x_m_per_s, 0.5, 1e-8);
}

TEST(RoverWheels, WheelsOfDifferentSpeedDriveACircle) {
  Bench bench(1.0);
  bench.inputs.wheels_left_speed_m_per_s = 0.2;
  bench.inputs.wheels_right_speed_m_per_s = 0.4;
  bench.run(2.0, 200);  // the wheels reach their speeds
  const auto begin = bench.outputs;
  // By hand: a yaw rate of (0.4 - 0.2) / 0.2 = 1 rad/s, a radius of 0.3 m.
  bench.run(2.0 * std::acos(-1.0), 2000);
  EXPECT_NEAR(bench.outputs.yaw_rad - begin.yaw_rad, 2.0 * std::acos(-1.0), 1e-6);
  EXPECT_NEAR(bench.outputs.position_x_m, begin.position_x_m, 1e-5);
  EXPECT_NEAR(bench.outputs.position_y_m, begin.position_y_m, 1e-5);
}

TEST(RoverWheels, AThinnerWheelTurnsTheRoverAndNotItsOdometer) {
  Bench bench(0.9);
  bench.inputs.wheels_left_speed_m_per_s = bench.inputs.wheels_right_speed_m_per_s = 0.5;
  bench.run(1.0, 100);
  EXPECT_EQ(bench.outputs.wheels_left_way_m, bench.outputs.wheels_right_way_m);
  EXPECT_NEAR(bench.outputs.yaw_rad, -0.1 * bench.outputs.wheels_left_way_m / 0.2, 1e-12);
}

}  // namespace
}  // namespace mebots::rover_wheels
