// SPDX-License-Identifier: Apache-2.0
#include "support.hpp"

#include <cmath>
#include <limits>

namespace mebots::battery {
namespace {

TEST(Battery, TerminalVoltageSagsByR0TimesCurrentOnLoadStep) {
  Inputs load;
  load.load_power_w[load::motors] = 8;
  const Bench idle(parameters("bitcraze_250", 0.8));
  const Bench loaded(parameters("bitcraze_250", 0.8), load);
  const double r0 = loaded.model.cell().circuit_at(0.8).series_ohm;
  const double sag_v = idle.outputs.cell_voltage_v - loaded.outputs.cell_voltage_v;
  EXPECT_NEAR(sag_v, r0 * loaded.outputs.cell_current_a, 1e-14);
  EXPECT_GT(sag_v, 0.2);
  EXPECT_NEAR(loaded.outputs.cell_voltage_v * loaded.outputs.cell_current_a, 8, 1e-13);
}

TEST(Battery, OutputsBelongTogetherAtEveryCommunicationPoint) {
  Bench bench(parameters("lipol_350", 0.7));
  bench.inputs.load_power_w = {7, 0.12, 0.01, 0.96, 0.1};
  for (int i = 0; i < 500; ++i) {
    bench.step(2 * kMillisecond);
    const double drawn_w = 7 + 0.12 / 0.906 + 0.01 + 0.96 + 0.1;  // the core converter at 100 mA
    ASSERT_NEAR(bench.outputs.bus_voltage_v * bench.outputs.cell_current_a, drawn_w, 1e-12);
    ASSERT_EQ(bench.outputs.bus_voltage_v, bench.outputs.cell_voltage_v);
  }
}

TEST(Battery, StateOfChargeCountsTheCoulombsOfAConstantCurrent) {
  // At constant power, the current increases while the voltage falls. So the charge is between the products of the time
  // with the first and with the last current.
  Bench bench(parameters("bitcraze_250", 0.8));
  bench.inputs.load_power_w[load::auxiliary] = 2;
  bench.step(kMillisecond);
  const double first_a = bench.outputs.cell_current_a;
  const double first_soc = bench.outputs.cell_state_of_charge;
  for (int i = 0; i < 10'000; ++i) bench.step(kMillisecond);
  const double last_a = bench.outputs.cell_current_a;
  const double charge_c = (first_soc - bench.outputs.cell_state_of_charge) * bench.outputs.cell_capacity_c;
  ASSERT_GT(last_a, first_a);
  EXPECT_GT(charge_c, first_a * 10);
  EXPECT_LT(charge_c, last_a * 10 + 1e-3);
}

TEST(Battery, MassAndCapacityComeFromTheCellFile) {
  const Bench bench(parameters("cyclone_300", 1));
  EXPECT_DOUBLE_EQ(bench.outputs.cell_mass_kg, 0.0081);
  EXPECT_DOUBLE_EQ(bench.outputs.cell_capacity_c, 1080);
}

TEST(Battery, SelfDischargeAloneEmptiesAsItsCurrentSays) {
  Bench bench(parameters("bitcraze_250", 0.5));
  for (int i = 0; i < 24; ++i) bench.step(3600 * kSecond);
  const double lost_c = (0.5 - bench.outputs.cell_state_of_charge) * bench.outputs.cell_capacity_c;
  EXPECT_NEAR(lost_c, bench.model.cell().self_discharge_current_a * 86400, 1e-6 * lost_c);
  EXPECT_GT(bench.outputs.energy_self_discharge_j, 0);
  EXPECT_EQ(bench.outputs.cell_current_a, 0);
}

TEST(Battery, RestoredRunContinuesWithTheSameBits) {
  const auto drive = [](Bench& bench, int from, int to) {
    for (int i = from; i < to; ++i) {
      bench.inputs.load_power_w = {7 + 2 * std::sin(0.1 * i), 0.08, 0.003 * (i % 3), 0.96, 0};
      bench.inputs.source_power_w = i % 13 == 0 ? 2 : 0;
      bench.step((1 + i % 4) * kMillisecond);
    }
  };
  Bench straight(parameters("bitcraze_250", 0.6));
  drive(straight, 0, 2000);

  Bench first(parameters("bitcraze_250", 0.6));
  drive(first, 0, 1000);
  const auto saved = state::save(first.model);
  Bench second(parameters("bitcraze_250", 0.6));
  drive(second, 0, 17);  // changes the state before the restore
  state::restore(second.model, saved);
  second.now_ns = first.now_ns;
  drive(second, 1000, 2000);

  EXPECT_EQ(state::first_difference(straight.model, second.model), std::nullopt);
  EXPECT_EQ(straight.outputs.bus_voltage_v, second.outputs.bus_voltage_v);
  EXPECT_EQ(straight.outputs.energy_ohmic_j, second.outputs.energy_ohmic_j);
}

TEST(Battery, StepLengthDoesNotMatterWhenInputsAreHeld) {
  const auto run = [](std::int64_t step_ns) {
    Bench bench(parameters("bitcraze_250", 0.7));
    bench.inputs.load_power_w = {8, 0.1, 0, 0.96, 0};
    for (std::int64_t t = 0; t < 10 * kSecond; t += step_ns) bench.step(step_ns);
    return bench.outputs;
  };
  const Outputs fine = run(2 * kMillisecond);
  const Outputs coarse = run(kSecond);
  // The tolerances cover the errors of at most 5000 steps, each of which has the tolerances 1e-10 V and 1e-9
  // (relative).
  EXPECT_NEAR(fine.bus_voltage_v, coarse.bus_voltage_v, 1e-8);
  EXPECT_NEAR(fine.cell_state_of_charge, coarse.cell_state_of_charge, 1e-9);
  EXPECT_NEAR(fine.energy_ohmic_j, coarse.energy_ohmic_j, 1e-7);
}

TEST(Battery, StepDoesNotAllocateOnceWarm) {
  if (allocations() < 0) GTEST_SKIP() << "the sanitizer owns malloc";
  Bench bench(parameters("bitcraze_250", 0.8));
  bench.inputs.load_power_w = {8, 0.1, 0.01, 0.96, 0};
  for (int i = 0; i < 10; ++i) bench.step(2 * kMillisecond);
  const long before = allocations();
  for (int i = 0; i < 1000; ++i) {
    bench.inputs.load_power_w[load::motors] = 7 + i % 5 * 0.2;
    bench.step(2 * kMillisecond);
  }
  EXPECT_EQ(allocations() - before, 0);
}

TEST(Battery, PowerThatIsNegativeOrNotANumberIsRefused) {
  Bench bench;
  bench.inputs.load_power_w[load::camera] = -0.1;
  EXPECT_THAT(error_of([&] { bench.step(kMillisecond); }), testing::HasSubstr("camera.power = -0.1 W"));
  bench.inputs.load_power_w[load::camera] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_of([&] { bench.step(kMillisecond); }), testing::HasSubstr("camera.power = nan W"));
  bench.inputs.load_power_w[load::camera] = 0;
  bench.inputs.source_power_w = -1;
  EXPECT_THAT(error_of([&] { bench.step(kMillisecond); }), testing::HasSubstr("source.power = -1 W"));
}

TEST(Battery, PowerThatMakesTheVoltageInfiniteIsRefusedAtTheStart) {
  Inputs inputs;
  inputs.source_power_w = 1e308;
  EXPECT_THAT(error_of([&] { Bench(parameters("bitcraze_250", 0.5), inputs); }),
              testing::HasSubstr("source.power = 1e+308 W makes bus.voltage inf V"));
}

TEST(Battery, StateOfChargeOutsideItsRangeIsRefused) {
  EXPECT_THAT(error_of([] { Bench{parameters("bitcraze_250", 1.2)}; }),
              testing::HasSubstr("cell.initial_state_of_charge = 1.2"));
}

TEST(Battery, InstancesDoNotKnowOfEachOther) {
  Bench alone(parameters("bitcraze_250", 0.9));
  Bench one(parameters("bitcraze_250", 0.9));
  Bench other(parameters("lipol_350", 0.4));
  for (int i = 0; i < 200; ++i) {
    for (Bench* bench : {&alone, &one, &other}) bench->inputs.load_power_w[load::motors] = bench == &other ? 3 : 8;
    alone.step(2 * kMillisecond);
  }
  for (int i = 0; i < 200; ++i) {
    one.step(2 * kMillisecond);
    other.step(2 * kMillisecond);
  }
  EXPECT_EQ(state::first_difference(alone.model, one.model), std::nullopt);
}

}  // namespace
}  // namespace mebots::battery
