// SPDX-License-Identifier: Apache-2.0
#include "support.hpp"

#include <cmath>

namespace mebots::battery {
namespace {

using testing::HasSubstr;

TEST(Protection, OpensWhenTheVoltageFallsUnderTheCutOffAndStaysOpen) {
  Bench bench(parameters("bitcraze_250", 0.3));
  bench.inputs.load_power_w[load::motors] = 9.5;
  double last_voltage_v = bench.outputs.bus_voltage_v;
  while (bench.outputs.cell_connected) {
    last_voltage_v = bench.outputs.bus_voltage_v;
    bench.step(10 * kMillisecond);
  }
  EXPECT_GE(last_voltage_v, 2.8);
  EXPECT_LT(last_voltage_v, 2.82);
  EXPECT_GT(bench.outputs.cell_state_of_charge, 0);
  EXPECT_EQ(bench.outputs.bus_voltage_v, 0);
  EXPECT_EQ(bench.outputs.cell_current_a, 0);
  EXPECT_GT(bench.outputs.cell_voltage_v, 3);  // the cell itself recovers
  ASSERT_FALSE(bench.events.empty());
  EXPECT_THAT(bench.events.back(), HasSubstr("falls under the cut-off of 2.8 V"));

  const double delivered_j = bench.outputs.energy_delivered_j;
  bench.inputs.load_power_w[load::motors] = 0.1;
  bench.inputs.source_power_w = 1;
  for (int i = 0; i < 100; ++i) bench.step(kSecond);
  EXPECT_FALSE(bench.outputs.cell_connected);
  EXPECT_EQ(bench.outputs.bus_voltage_v, 0);
  EXPECT_EQ(bench.outputs.energy_delivered_j, delivered_j);
  EXPECT_EQ(bench.outputs.energy_source_j, 0);
}

TEST(Protection, OpensInsideAStepAtTheSameInstantWhateverTheStep) {
  const auto delivered_until_open = [](std::int64_t step_ns) {
    Bench bench(parameters("bitcraze_250", 0.3));
    bench.inputs.load_power_w[load::motors] = 9.5;
    while (bench.outputs.cell_connected) bench.step(step_ns);
    return bench.outputs.energy_delivered_j / 9.5;
  };
  const double fine_s = delivered_until_open(kMillisecond);
  const double coarse_s = delivered_until_open(7 * kSecond);
  EXPECT_GT(fine_s, 10);
  // The voltage falls by some 5 mV/s here and the interpolant inside a long step is good to 1e-7 V.
  EXPECT_NEAR(fine_s, coarse_s, 1e-4);
}

TEST(Protection, OpensAtOnceWhenNoCurrentGivesThatPower) {
  Bench bench(parameters("bitcraze_250", 0.8));
  bench.step(kMillisecond);
  bench.inputs.load_power_w[load::auxiliary] = 500;
  bench.step(kMillisecond);
  EXPECT_FALSE(bench.outputs.cell_connected);
  EXPECT_EQ(bench.outputs.energy_delivered_j, 0);
  EXPECT_THAT(bench.events.back(), HasSubstr("t = 0.001 s"));
}

TEST(Protection, OpensAtTheStartWhenTheFirstLoadIsTooMuch) {
  Inputs heavy;
  heavy.load_power_w[load::motors] = 500;
  const Bench bench(parameters("bitcraze_250", 0.8), heavy);
  EXPECT_FALSE(bench.outputs.cell_connected);
  EXPECT_EQ(bench.outputs.bus_voltage_v, 0);
}

TEST(Protection, OpensAtStateOfChargeZero) {
  const Bench empty(parameters("bitcraze_250", 0));
  EXPECT_FALSE(empty.outputs.cell_connected);
  EXPECT_THAT(empty.events.back(), HasSubstr("empty"));

  // With no cut-off in the way a load draws the last charge, and the instant is found.
  Cell cell = cell_named("bitcraze_250");
  cell.cut_off_voltage_v = 0;
  Integrator integrator(cell);
  CellState state{0.001, 0, 0};
  Ledger ledger;
  const Demand half_watt{0.5, 0.5, 0, 0};
  const auto [reached_s, event] = integrator.advance(state, ledger, half_watt, true, 100);
  EXPECT_EQ(event, Event::empty);
  EXPECT_EQ(state.soc, 0);
  // 0.9 C between 2.65 V and 2.69 V are 2.4 J, less what the resistances take at 0.2 A.
  EXPECT_GT(reached_s, 4);
  EXPECT_LT(reached_s, 2.69 * 0.9 / 0.5);
  EXPECT_NEAR(ledger.delivered_j, 0.5 * reached_s, 1e-9);
}

TEST(Protection, SelfDischargeStopsAtStateOfChargeZero) {
  Bench bench(parameters("bitcraze_250", 0.001));  // under the cut-off: open from the start
  ASSERT_FALSE(bench.outputs.cell_connected);
  for (int i = 0; i < 48; ++i) bench.step(3600 * kSecond);  // 0.9 C at 18 uA last 14 hours
  EXPECT_EQ(bench.outputs.cell_state_of_charge, 0);
  EXPECT_NEAR(bench.outputs.energy_imbalance_j, 0, 1e-12);
}

TEST(Protection, OverCurrentIsOnlyAFlag) {
  Bench bench(parameters("bitcraze_250", 0.9));
  bench.inputs.load_power_w[load::motors] = 13;
  bench.step(2 * kMillisecond);
  bench.step(2 * kMillisecond);
  EXPECT_GT(bench.outputs.cell_current_a, 3);
  EXPECT_TRUE(bench.outputs.cell_over_current);
  EXPECT_TRUE(bench.outputs.cell_connected);
  bench.inputs.load_power_w[load::motors] = 5;
  bench.step(2 * kMillisecond);
  EXPECT_FALSE(bench.outputs.cell_over_current);
}

TEST(Protection, OverCurrentIsToldOnceItHasLastedASecond) {
  Bench bench(parameters("bitcraze_250", 0.9));
  const auto draw = [&bench](double power_w, int milliseconds) {
    bench.inputs.load_power_w[load::motors] = power_w;
    for (int i = 0; i < milliseconds; i += 2) bench.step(2 * kMillisecond);
  };
  draw(13, 800);
  draw(5, 2);  // a break: it counts from anew
  draw(13, 1000);
  EXPECT_TRUE(bench.events.empty());
  draw(13, 2);
  ASSERT_EQ(bench.events.size(), 1U);
  EXPECT_THAT(bench.events.back(), HasSubstr("above the cell's continuous limit of 3 A for 1 s"));
  draw(13, 2000);
  EXPECT_EQ(bench.events.size(), 1U);  // once, not at every step
}

TEST(Charging, SourceIsANegativeLoad) {
  Bench bench(parameters("bitcraze_250", 0.5));
  bench.inputs.source_power_w = 1;
  const double voltage_v = bench.outputs.cell_voltage_v;
  for (int i = 0; i < 1000; ++i) bench.step(10 * kMillisecond);
  EXPECT_LT(bench.outputs.cell_current_a, 0);
  EXPECT_GT(bench.outputs.cell_voltage_v, voltage_v);
  EXPECT_GT(bench.outputs.cell_state_of_charge, 0.5);
  EXPECT_NEAR(bench.outputs.energy_source_j, 10, 1e-9);
}

TEST(Charging, SourcePowerIsMultipliedByItsConvertersEfficiency) {
  Parameters chosen = parameters("bitcraze_250", 0.5);
  chosen.source_converter = "core";
  Bench bench(chosen);
  bench.inputs.source_power_w = 0.12 / 0.906;  // gives 100 mA at 1.2 V
  bench.step(kSecond);
  EXPECT_NEAR(bench.outputs.bus_voltage_v * bench.outputs.cell_current_a, -0.12, 1e-12);
}

TEST(Charging, FullCellRefusesChargeAndTheSourceCarriesTheLoads) {
  Bench bench(parameters("bitcraze_250", 0.9995));
  bench.inputs.load_power_w[load::avionics] = 0.5;
  bench.inputs.source_power_w = 4;
  for (int i = 0; i < 50; ++i) bench.step(100 * kMillisecond);
  EXPECT_NEAR(bench.outputs.cell_state_of_charge, 1, 1e-6);
  EXPECT_LE(bench.outputs.cell_state_of_charge, 1);
  EXPECT_EQ(bench.outputs.cell_current_a, 0);
  const double source_j = bench.outputs.energy_source_j;
  bench.step(kSecond);
  EXPECT_NEAR(bench.outputs.energy_source_j - source_j, 0.5, 1e-12);
  EXPECT_THAT(bench.events.back(), HasSubstr("full"));
}

TEST(Charging, BeginsAgainWhenTheCellIsNoLongerFull) {
  Bench bench(parameters("bitcraze_250", 1));
  bench.inputs.load_power_w[load::avionics] = 4;
  while (bench.outputs.cell_state_of_charge >= Model::kResumeChargingBelow) bench.step(100 * kMillisecond);
  bench.inputs.load_power_w[load::avionics] = 0;
  bench.inputs.source_power_w = 2;
  bench.step(100 * kMillisecond);
  EXPECT_LT(bench.outputs.cell_current_a, 0);
}

}  // namespace
}  // namespace mebots::battery
