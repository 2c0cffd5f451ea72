// SPDX-License-Identifier: Apache-2.0
// Tests that the terms of the ledger balance, and that they agree with sums that are computed here.
#include "support.hpp"

#include <cmath>

namespace mebots::battery {
namespace {

/// Returns the integral of the published open-circuit voltage over state of charge, in closed form.
double open_circuit_integral(double from_s, double to_s) {
  const auto antiderivative = [](double s) {
    return 1.031 / 35 * std::exp(-35 * s) + 3.685 * s + 0.2156 * s * s / 2 - 0.1178 * s * s * s / 3 +
           0.3201 * s * s * s * s / 4;
  };
  return antiderivative(to_s) - antiderivative(from_s);
}

/// Simulates a flight. The loads change at every communication point, and a source delivers power at times.
void drive(
    Bench& bench, int steps, std::int64_t step_ns, const std::function<void()>& after_step = [] {}) {
  for (int i = 0; i < steps; ++i) {
    bench.inputs.load_power_w = {6 + 3 * std::sin(0.05 * i), 0.05 + 0.04 * std::cos(0.3 * i), 0.003, 0.96,
                                 i % 7 == 0 ? 0.4 : 0.0};
    bench.inputs.source_power_w = i % 11 < 4 ? 1.5 : 0.0;
    bench.step(step_ns);
    after_step();
  }
}

TEST(Ledger, ClosesOverAFlightWithChangingLoadsAndASource) {
  Parameters chosen = parameters("bitcraze_250", 0.9);
  chosen.source_converter = "core";
  Bench bench(chosen);
  drive(bench, 50'000, 2 * kMillisecond);
  const Outputs& out = bench.outputs;
  ASSERT_TRUE(out.cell_connected);
  EXPECT_GT(out.energy_delivered_j, 500);
  EXPECT_GT(out.energy_converters_j, 0.1);
  EXPECT_GT(out.energy_polarisation_j, 0.1);
  EXPECT_GT(out.energy_self_discharge_j, 0);
  EXPECT_GT(out.energy_source_j, 10);
  // The time derivative of the ledger's balance is zero, so the Runge-Kutta method conserves the balance. Only rounding
  // errors remain.
  EXPECT_NEAR(out.energy_imbalance_j, 0, 1e-10 * out.energy_open_circuit_j);
}

TEST(Ledger, DeliveredEnergyIsTheSumOfHeldPowersTimesTime) {
  Bench bench(parameters("bitcraze_250", 0.9));
  std::array<double, load::kCount> sum_j{};
  double source_j = 0;
  drive(bench, 5'000, 2 * kMillisecond, [&] {
    for (std::size_t i = 0; i < load::kCount; ++i) sum_j[i] += bench.inputs.load_power_w[i] * 0.002;
    source_j += bench.inputs.source_power_w * 0.002;
  });
  double all_j = 0;
  for (std::size_t i = 0; i < load::kCount; ++i) {
    EXPECT_NEAR(bench.outputs.load_energy_j[i], sum_j[i], 1e-12 * sum_j[i]);
    all_j += sum_j[i];
  }
  EXPECT_NEAR(bench.outputs.energy_delivered_j, all_j, 1e-11 * all_j);
  EXPECT_NEAR(bench.outputs.energy_source_j, source_j, 1e-11 * source_j);
}

TEST(Ledger, ConverterLossesAreThePowersTimesWhatEfficiencyLeaves) {
  Bench bench(parameters("bitcraze_250", 0.9));
  bench.inputs.load_power_w[load::soc] = 1.2 * 0.1;  // 100 mA at the core rail: 90.6 %
  for (int i = 0; i < 1000; ++i) bench.step(2 * kMillisecond);
  EXPECT_NEAR(bench.outputs.energy_converters_j, 2 * 0.12 * (1 / 0.906 - 1), 1e-12);
}

TEST(Ledger, OpenCircuitEnergyIsTheChargeTimesTheVoltageIntegral) {
  Bench bench(parameters("bitcraze_250", 0.95));
  drive(bench, 50'000, 2 * kMillisecond);
  const double s = bench.outputs.cell_state_of_charge;
  ASSERT_LT(s, 0.8);
  const double expected_j = bench.outputs.cell_capacity_c * open_circuit_integral(s, 0.95);
  // The solver integrates the power over time; the expected value is the integral of the voltage over the charge. The
  // solver's tolerances per step are 1e-10 J and 1e-12 of the charge.
  EXPECT_NEAR(bench.outputs.energy_open_circuit_j, expected_j, 1e-6 * expected_j);
  EXPECT_NEAR(bench.outputs.energy_open_circuit_j, expected_j, 1e-7);
}

TEST(Ledger, ClosesThroughTheOpeningOfTheProtection) {
  Bench bench(parameters("bitcraze_250", 0.2));
  bench.inputs.load_power_w = {9, 0.1, 0, 0.96, 0};
  while (bench.outputs.cell_connected) bench.step(100 * kMillisecond);
  for (int i = 0; i < 100; ++i) bench.step(kSecond);
  EXPECT_GT(bench.outputs.energy_delivered_j, 100);
  EXPECT_NEAR(bench.outputs.energy_imbalance_j, 0, 1e-10 * bench.outputs.energy_open_circuit_j);
}

TEST(Ledger, ClosesWhileChargingToTheFull) {
  Bench bench(parameters("bitcraze_250", 0.99));
  bench.inputs.load_power_w[load::avionics] = 0.5;
  bench.inputs.source_power_w = 3;
  for (int i = 0; i < 600; ++i) bench.step(100 * kMillisecond);
  EXPECT_LT(bench.outputs.energy_open_circuit_j, 0);
  EXPECT_GT(bench.outputs.energy_source_j, bench.outputs.energy_delivered_j);
  EXPECT_NEAR(bench.outputs.energy_imbalance_j, 0, 1e-10 * bench.outputs.energy_source_j);
}

TEST(Ledger, LossesPowerIsTheMeanOverTheStep) {
  Bench bench(parameters("bitcraze_250", 0.6));
  bench.inputs.load_power_w = {8, 0.2, 0, 0, 0};
  double sum_j = 0;
  for (int i = 0; i < 200; ++i) {
    bench.step(50 * kMillisecond);
    sum_j += bench.outputs.losses_power_w * 0.05;
  }
  EXPECT_NEAR(sum_j, bench.outputs.energy_ohmic_j + bench.outputs.energy_converters_j, 1e-11 * sum_j);
}

}  // namespace
}  // namespace mebots::battery
