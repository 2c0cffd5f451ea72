// SPDX-License-Identifier: Apache-2.0
#include "model.hpp"
#include "mebots/error.hpp"

#include <gtest/gtest.h>

namespace mebots::motor_thermal {
namespace {

struct Bench {
  Bench() : model(parameters, ".") { model.start(inputs, outputs); }

  /// Sets the inputs of a hovering drone's motor. Its winding carries 1.2 A.
  void hover() {
    inputs.motor_power_w = 10;
    inputs.motor_command = 0.58;
    inputs.bus_voltage_v = 3.6;
  }
  void run(double seconds, int steps) {
    for (int i = 0; i < steps; ++i) model.step(inputs, static_cast<std::int64_t>(1e9 * seconds / steps), outputs);
  }

  Parameters parameters;
  Inputs inputs;
  Outputs outputs;
  Model model;
};

TEST(MotorThermal, AnIdleMotorStaysAtTheAirsTemperature) {
  Bench bench;
  bench.run(100, 10);
  EXPECT_DOUBLE_EQ(bench.outputs.winding_temperature_k, 293.15);
  EXPECT_DOUBLE_EQ(bench.outputs.case_temperature_k, 293.15);
}

TEST(MotorThermal, SettlesWhereLossesLeaveThroughTheCase) {
  Bench bench;
  bench.hover();
  bench.run(3600, 3600);
  const double current = 2.5 / (0.58 * 3.6);
  const auto& p = bench.parameters;
  // The solution by hand of W = I^2 R (1 + a (T_w - 20 degC)), T_c = T_air + W / G_c, T_w = T_c + W / G_w.
  const double series = 1 / p.winding_conductance_w_per_k + 1 / p.case_conductance_w_per_k;
  const double loss = current * current * p.winding_resistance_ohm;
  const double heat = loss / (1 - loss * 0.00393 * series);
  EXPECT_NEAR(bench.outputs.case_temperature_k, 293.15 + heat / p.case_conductance_w_per_k, 1e-6);
  EXPECT_NEAR(bench.outputs.winding_temperature_k, 293.15 + heat * series, 1e-6);
}

TEST(MotorThermal, HeatIsStoredOrGivenAway) {
  Bench bench;
  bench.hover();
  bench.run(20, 700);
  bench.inputs = {};
  bench.run(20, 300);
  const auto& [p, o] = std::pair{bench.parameters, bench.outputs};
  const double stored = p.winding_heat_capacity_j_per_k * (o.winding_temperature_k - 293.15) +
                        p.case_heat_capacity_j_per_k * (o.case_temperature_k - 293.15);
  // The step is exact, so only the rounding of 1000 additions remains.
  EXPECT_NEAR(o.heat_copper_j, stored + o.heat_air_j, 1e-10 * o.heat_copper_j);
}

TEST(MotorThermal, ALongStepIsAsGoodAsManyShortOnes) {
  Bench one;
  Bench many;
  one.hover();
  many.hover();
  one.run(10, 1);
  many.run(10, 5000);
  EXPECT_NEAR(one.outputs.winding_temperature_k, many.outputs.winding_temperature_k, 1e-9);
  EXPECT_NEAR(one.outputs.heat_air_j, many.outputs.heat_air_j, 1e-9);
}

TEST(MotorThermal, AWindingThatBurnsIsAnError) {
  Bench bench;
  bench.inputs.motor_power_w = 200;
  bench.inputs.motor_command = 1;
  EXPECT_THROW(bench.run(100, 100), Error);
}

}  // namespace
}  // namespace mebots::motor_thermal
