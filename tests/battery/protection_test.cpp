// SPDX-License-Identifier: Apache-2.0
#include "support.hpp"

#include <fmt/format.h>

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
  // The resting cell is above the release voltage, but only a charging current closes the protection. A source with
  // less power than the loads does not charge the cell.
  bench.inputs.load_power_w[load::motors] = 1.1;
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
  // The voltage decreases by about 5 mV/s here, and the interpolant inside a long step is accurate to 1e-7 V.
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

constexpr double kDelay_s = 0.144;  // of bitcraze_250_flights

/// This load lowers the terminal voltage of bitcraze_250_flights below the cut-off at a state of charge of 0.3. The
/// cell can still deliver this power.
constexpr double kLow_w = 20;

TEST(ProtectionDelay, OpensOnceTheVoltageWasLowForTheDelayWhateverTheStep) {
  for (const std::int64_t step_ns : {kMillisecond, 7 * kMillisecond, 2 * kSecond}) {
    Bench bench(parameters("bitcraze_250_flights", 0.3));
    bench.inputs.load_power_w[load::motors] = kLow_w;
    while (bench.outputs.cell_connected) bench.step(step_ns);
    EXPECT_NEAR(bench.outputs.energy_delivered_j / kLow_w, kDelay_s, 1e-9);
    EXPECT_THAT(bench.events.back(),
                HasSubstr("t = 0.144 s: the terminal voltage has been under the cut-off of 2.8 V"));
    EXPECT_NEAR(bench.outputs.energy_imbalance_j, 0, 1e-9);
  }
}

TEST(ProtectionDelay, BeginsAgainAfterTheVoltageRecovered) {
  Bench bench(parameters("bitcraze_250_flights", 0.3));
  for (int i = 0; i < 10; ++i) {
    bench.inputs.load_power_w[load::motors] = kLow_w;
    for (int k = 0; k < 70; ++k) bench.step(2 * kMillisecond);
    EXPECT_LT(bench.outputs.bus_voltage_v, 2.8);
    EXPECT_TRUE(bench.outputs.cell_connected);
    bench.inputs.load_power_w[load::motors] = 1;
    bench.step(2 * kMillisecond);
    EXPECT_GT(bench.outputs.bus_voltage_v, 2.8);
  }
  EXPECT_TRUE(bench.events.empty());
}

TEST(ProtectionDelay, IsSavedOnTheWay) {
  Bench straight(parameters("bitcraze_250_flights", 0.3));
  straight.inputs.load_power_w[load::motors] = kLow_w;
  for (int k = 0; k < 50; ++k) straight.step(2 * kMillisecond);
  Bench restored(parameters("bitcraze_250_flights", 0.3));
  state::restore(restored.model, state::save(straight.model));
  restored.now_ns = straight.now_ns;
  restored.inputs = straight.inputs;
  for (auto* bench : {&straight, &restored}) bench->step(kSecond);
  EXPECT_EQ(straight.events.back(), restored.events.back());
  EXPECT_EQ(straight.outputs.energy_delivered_j, restored.outputs.energy_delivered_j);
}

TEST(ProtectionDelay, DoesNotHoldWhereNoCurrentGivesThePower) {
  Bench bench(parameters("bitcraze_250_flights", 0.8));
  bench.step(kMillisecond);
  bench.inputs.load_power_w[load::auxiliary] = 500;
  bench.step(kMillisecond);
  EXPECT_FALSE(bench.outputs.cell_connected);
  EXPECT_EQ(bench.outputs.energy_delivered_j, 0);
  EXPECT_THAT(bench.events.back(), HasSubstr("no current gives the power"));
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

  // If a cell has no cut-off voltage, a load can discharge it completely.
  Cell cell = cell_named("bitcraze_250");
  cell.cut_off_voltage_v = 0;
  Integrator integrator(cell);
  CellState state{0.001, 0, 0};
  Ledger ledger;
  const Demand half_watt{0.5, 0.5, 0, 0};
  const auto [reached_s, event] = integrator.advance(state, ledger, half_watt, Protection::closed, 100);
  EXPECT_EQ(event, Event::empty);
  EXPECT_EQ(state.soc, 0);
  // The charge of 0.9 C delivers at most 2.69 V * 0.9 C, less the loss in the resistances.
  EXPECT_GT(reached_s, 4);
  EXPECT_LT(reached_s, 2.69 * 0.9 / 0.5);
  EXPECT_NEAR(ledger.delivered_j, 0.5 * reached_s, 1e-9);
}

TEST(Protection, SelfDischargeStopsAtStateOfChargeZero) {
  Bench bench(parameters("bitcraze_250", 0.001));  // below the cut-off: open from the start
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

void draw(Bench& bench, double power_w, double time_s) {
  bench.inputs.load_power_w[load::motors] = power_w;
  for (int i = 0; i < std::lround(100 * time_s); ++i) bench.step(10 * kMillisecond);
}

TEST(Protection, TerminationReportsTimeAboveTheContinuousLimitAndLargestCurrent) {
  Bench bench(parameters("bitcraze_250", 0.9));
  bench.model.terminate();
  EXPECT_TRUE(bench.events.empty());
  draw(bench, 5, 1);
  draw(bench, 13, 0.8);
  const double largest_a = bench.outputs.cell_current_a;
  draw(bench, 5, 1);
  draw(bench, 12.5, 0.7);
  EXPECT_TRUE(bench.events.empty());
  bench.model.terminate();
  ASSERT_EQ(bench.events.size(), 1U);
  EXPECT_TRUE(bench.warnings.empty());
  EXPECT_THAT(bench.events.back(), HasSubstr("above the cell's continuous limit of 3 A for 1.5 s"));
  EXPECT_THAT(bench.events.back(), HasSubstr(fmt::format("{:.3f} A", largest_a)));
}

TEST(Protection, AWarningComesWhenTheMeanSquareOfTheCurrentExceedsThatOfTheLimit) {
  // A constant current i heats a cold cell to the limit i_max after T = -tau log(1 - (i_max / i)^2).
  Bench bench(parameters("bitcraze_250_flights", 1));
  bench.inputs.load_power_w[load::motors] = 14;
  double expected = 0;  // the solution of the differential equation, step by step, from the model's currents
  double first_s = 0;
  while (bench.warnings.empty() && bench.now_ns < 200 * kSecond) {
    bench.step(10 * kMillisecond);
    const double square_a2 = bench.outputs.cell_current_a * bench.outputs.cell_current_a;
    expected = square_a2 + (expected - square_a2) * std::exp(-0.01 / Model::kHeatingTimeConstant_s);
    if (first_s == 0 && expected > 9) first_s = 1e-9 * static_cast<double>(bench.now_ns);
  }
  ASSERT_EQ(bench.warnings.size(), 1U);
  EXPECT_NEAR(1e-9 * static_cast<double>(bench.now_ns), first_s, 0.03);
  EXPECT_GT(first_s, 60);
  EXPECT_THAT(bench.warnings.back(), HasSubstr("heats the cell more than its continuous limit of 3 A"));
  bench.step(10 * kSecond);
  EXPECT_EQ(bench.warnings.size(), 1U);  // once in a run
}

/// Returns a cell whose charging with constant power has a closed form: E = 2.5 V + 1.7 V s, R0 = 0.2 Ohm, negligible
/// RC pairs.
Cell straight_cell() {
  Cell cell = cell_named("bitcraze_250");
  cell.capacity_c = 100;
  cell.self_discharge_current_a = 0;
  cell.cut_off_voltage_v = 2.8;
  cell.release_voltage_v = 3.0;
  cell.open_circuit_v = Curve::analytic(0, 0, {2.5, 1.7});
  cell.series_ohm = Curve::analytic(0, 0, {0.2});
  cell.pair1_ohm = cell.pair2_ohm = Curve::analytic(0, 0, {1});
  cell.pair1_farad = cell.pair2_farad = Curve::analytic(0, 0, {1e12});
  return cell;
}

TEST(Charging, AnEmptyCellIsReleasedWhenTheClosedFormSays) {
  // From V i = P and V = E + R i follow V = (E + sqrt(E^2 + 4 R P)) / 2 and t = Q / (b P) times the integral of V dE.
  constexpr double kPower_w = 2;
  constexpr double kFourRp = 4 * 0.2 * kPower_w;
  const auto integral_of_v = [](double e) {
    return (e * e + e * std::sqrt(e * e + kFourRp) + kFourRp * std::asinh(e / std::sqrt(kFourRp))) / 4;
  };
  const double release_e = 3.0 - 0.2 * kPower_w / 3.0;
  const double release_s = 100 / (1.7 * kPower_w) * (integral_of_v(release_e) - integral_of_v(2.5));

  const Cell cell = straight_cell();
  Integrator integrator(cell);
  CellState state{0, 0, 0};
  Ledger ledger;
  const Demand charger{0, 0, kPower_w, kPower_w};
  const auto [reached_s, event] = integrator.advance(state, ledger, charger, Protection::open, 1000);
  EXPECT_EQ(event, Event::release);
  EXPECT_NEAR(reached_s, release_s, 1e-6 * release_s);
  EXPECT_NEAR(2.5 + 1.7 * state.soc, release_e, 1e-7);
  EXPECT_NEAR(ledger.source_j, kPower_w * reached_s, 1e-9);
  // The expected energy is -Q times the integral of E ds, with Q = 100 C and E = 2.5 V + 1.7 V s.
  EXPECT_NEAR(ledger.open_circuit_j, -100 * (2.5 * state.soc + 1.7 * state.soc * state.soc / 2), 1e-7);
  EXPECT_NEAR(ledger.imbalance_j(), 0, 1e-10 * ledger.source_j);
}

TEST(Charging, AnOpenProtectionBlocksDischargeOnly) {
  const Cell cell = straight_cell();
  Integrator integrator(cell);
  CellState state{0.1, 0, 0};
  Ledger ledger;
  EXPECT_EQ(integrator.advance(state, ledger, {1, 1, 0.5, 0.5}, Protection::open, 10).event, Event::none);
  EXPECT_EQ(state.soc, 0.1);
  EXPECT_EQ(ledger.delivered_j, 0);
  // Of the source's power, 0.5 W go to the load and 0.1 W to the cell.
  EXPECT_EQ(integrator.advance(state, ledger, {0.5, 0.5, 0.6, 0.6}, Protection::open, 10).event, Event::none);
  EXPECT_NEAR(ledger.delivered_j, 5, 1e-9);
  EXPECT_NEAR(ledger.source_j, 6, 1e-9);
  EXPECT_NEAR(state.soc, 0.1 + 10 * 0.1 / 2.675 / 100, 1e-5);
}

TEST(Charging, AnEmptiedCellComesBackAndEveryJouleIsAccountedFor) {
  Bench bench(parameters("bitcraze_250", 0.02));
  bench.inputs.load_power_w[load::motors] = 2;
  while (bench.outputs.cell_connected) bench.step(10 * kMillisecond);
  bench.inputs.load_power_w[load::motors] = 0;
  for (int i = 0; i < 600; ++i) bench.step(kSecond);
  ASSERT_FALSE(bench.outputs.cell_connected);
  EXPECT_EQ(bench.outputs.bus_voltage_v, 0);
  const double soc = bench.outputs.cell_state_of_charge;
  const double delivered_j = bench.outputs.energy_delivered_j;

  bench.inputs.load_power_w[load::avionics] = 0.1;
  bench.inputs.source_power_w = 0.5;
  double seconds = 0;
  for (; seconds < 600; ++seconds) bench.step(kSecond);
  EXPECT_TRUE(bench.outputs.cell_connected);
  EXPECT_THAT(bench.events.back(), HasSubstr("lifts the terminal voltage to 3 V"));
  EXPECT_GT(bench.outputs.bus_voltage_v, 3);
  EXPECT_LT(bench.outputs.cell_current_a, 0);
  EXPECT_GT(bench.outputs.cell_state_of_charge, soc);
  EXPECT_NEAR(bench.outputs.energy_source_j, 0.5 * seconds, 1e-9);
  EXPECT_NEAR(bench.outputs.energy_delivered_j - delivered_j, 0.1 * seconds, 1e-9);

  bench.inputs.source_power_w = 0;
  bench.inputs.load_power_w[load::motors] = 2;
  bench.step(kSecond);
  EXPECT_TRUE(bench.outputs.cell_connected);
  EXPECT_GT(bench.outputs.cell_current_a, 0);
  EXPECT_NEAR(bench.outputs.energy_imbalance_j, 0, 1e-9);
}

TEST(Charging, ACellWithoutAnyChargeComesBack) {
  Bench bench(parameters("bitcraze_250", 0));
  ASSERT_FALSE(bench.outputs.cell_connected);
  bench.inputs.source_power_w = 0.1;
  bench.step(kSecond);
  EXPECT_FALSE(bench.outputs.cell_connected);
  EXPECT_GT(bench.outputs.cell_state_of_charge, 0);
  EXPECT_GT(bench.outputs.bus_voltage_v, 2.6);  // the source holds the bus
  for (int i = 0; i < 600; ++i) bench.step(kSecond);
  EXPECT_TRUE(bench.outputs.cell_connected);
}

TEST(Charging, ALongStepReleasesAtTheSameInstantAsShortOnes) {
  Bench fine(parameters("bitcraze_250", 0));
  Bench coarse(parameters("bitcraze_250", 0));
  fine.inputs.source_power_w = coarse.inputs.source_power_w = 0.3;
  for (int i = 0; i < 4000; ++i) fine.step(100 * kMillisecond);
  coarse.step(400 * kSecond);
  ASSERT_EQ(coarse.events.size(), 2U);
  EXPECT_EQ(fine.events.size(), 2U);
  EXPECT_NEAR(fine.outputs.cell_state_of_charge, coarse.outputs.cell_state_of_charge, 1e-8);
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
