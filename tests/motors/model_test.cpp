// SPDX-License-Identifier: Apache-2.0
#include "support.hpp"

#include <cmath>
#include <limits>

namespace mebots::motors {
namespace {

using testing::HasSubstr;

TEST(Motors, SettleAtTheBenchsThrustAndPowerForItsCommandsAndVoltages) {
  for (const BenchRow& row : bench_rows()) {
    if (row.command == 0) continue;
    Stand stand;
    stand.command(row.command);
    stand.inputs.bus_voltage_v = row.voltage_v;
    stand.settle();
    // The tolerances are the largest residuals of the fits: 3.3 mN per rotor, and 0.35 W for four rotors.
    EXPECT_NEAR(stand.outputs.rotor_thrust_n[0], row.thrust_n, 3.3e-3);
    EXPECT_NEAR(stand.outputs.bench_power_w + stand.outputs.avionics_power_w, row.current_a * row.voltage_v, 0.35);
  }
}

TEST(Motors, StandingRotorsTakeNoPowerButAvionicsDoes) {
  Stand stand;
  stand.step(2 * kMillisecond);
  EXPECT_EQ(stand.outputs.power_w, 0);
  EXPECT_EQ(stand.outputs.hover_power_w, 0);
  EXPECT_EQ(stand.outputs.rotor_thrust_n[2], 0);
  EXPECT_EQ(stand.outputs.avionics_power_w, 0.96);
}

TEST(Motors, ThrustFallsWhenTheBusSags) {
  Stand stand;
  stand.command(0.75);
  stand.inputs.bus_voltage_v = 3.7;
  stand.settle();
  const double before_n = stand.outputs.rotor_thrust_n[0];
  stand.inputs.bus_voltage_v = 3.2;
  stand.settle();
  EXPECT_LT(stand.outputs.rotor_thrust_n[0], 0.85 * before_n);
  EXPECT_GT(stand.outputs.rotor_thrust_n[0], 0.5 * before_n);
}

TEST(Motors, TakesNoPowerWithoutVoltage) {
  Stand stand;
  stand.command(0.75);
  stand.settle();
  stand.inputs.bus_voltage_v = 0;
  const double before_n = stand.outputs.rotor_thrust_n[0];
  stand.step(2 * kMillisecond);
  EXPECT_EQ(stand.outputs.power_w, 0);
  EXPECT_EQ(stand.outputs.hover_power_w, 0);
  EXPECT_EQ(stand.outputs.avionics_power_w, 0);
  EXPECT_LT(stand.outputs.rotor_thrust_n[0], before_n);
  EXPECT_GT(stand.outputs.rotor_thrust_n[0], 0.9 * before_n);  // the rotor does not stop at once
}

TEST(Motors, RotorsAreIndependent) {
  Stand stand;
  stand.inputs.rotor_command = {0.3, 0.5, 0.7, 0};
  stand.settle();
  EXPECT_LT(stand.outputs.rotor_thrust_n[0], stand.outputs.rotor_thrust_n[1]);
  EXPECT_LT(stand.outputs.rotor_thrust_n[1], stand.outputs.rotor_thrust_n[2]);
  EXPECT_EQ(stand.outputs.rotor_thrust_n[3], 0);
  EXPECT_DOUBLE_EQ(stand.outputs.rotor_torque_n_m[1], 0.007350863 * stand.outputs.rotor_thrust_n[1]);
}

TEST(Motors, ThinAirGivesLessThrustAtTheSameSpeed) {
  Stand stand;
  stand.command(0.6);
  stand.settle();
  const double sea_n = stand.outputs.rotor_thrust_n[0];
  stand.inputs.air_density_kg_per_m3 = 0.98;
  stand.step(2 * kMillisecond);
  EXPECT_NEAR(stand.outputs.rotor_thrust_n[0], 0.8 * sea_n, 1e-9);
}

TEST(Motors, ChosenModelDrivesThePowerAndBothAreAlwaysOut) {
  for (const PowerModel chosen : {PowerModel::bench, PowerModel::hover_propel}) {
    Parameters parameters;
    parameters.power_model = chosen;
    Stand stand(parameters);
    stand.command(0.7);
    stand.inputs.body_speed_m_per_s = 0.5;
    double energy_j = 0;
    for (int i = 0; i < 100; ++i) {
      stand.step(2 * kMillisecond);
      energy_j += stand.outputs.power_w * 0.002;
    }
    EXPECT_EQ(stand.outputs.power_model_used, chosen);
    EXPECT_GT(stand.outputs.bench_power_w, 1);
    EXPECT_GT(stand.outputs.hover_power_w, 1);
    EXPECT_GT(stand.outputs.propel_power_w, 0.1);
    const double expected_w = chosen == PowerModel::bench ? stand.outputs.bench_power_w
                                                          : stand.outputs.hover_power_w + stand.outputs.propel_power_w;
    EXPECT_EQ(stand.outputs.power_w, expected_w);
    EXPECT_NEAR(stand.outputs.energy_j, energy_j, 1e-12 * energy_j);
  }
}

TEST(Motors, PowerIsTheMeanOverTheStepWhateverTheStep) {
  const auto energy_j = [](std::int64_t step_ns) {
    Stand stand;
    stand.command(0.8);
    for (std::int64_t t = 0; t < 400 * kMillisecond; t += step_ns) stand.step(step_ns);
    return stand.outputs.energy_j;
  };
  EXPECT_NEAR(energy_j(kMillisecond), energy_j(100 * kMillisecond), 1e-11 * energy_j(kMillisecond));
}

TEST(Motors, RestoredRunContinuesWithTheSameBits) {
  const auto drive = [](Stand& stand, int from, int to) {
    for (int i = from; i < to; ++i) {
      stand.inputs.rotor_command = {0.6 + 0.2 * std::sin(0.1 * i), 0.6, 0.5, i % 50 < 25 ? 0.7 : 0.0};
      stand.inputs.bus_voltage_v = 3.7 - 1e-4 * i;
      stand.step((1 + i % 3) * kMillisecond);
    }
  };
  Stand straight;
  drive(straight, 0, 1000);
  Stand first;
  drive(first, 0, 500);
  const auto saved = state::save(first.model);
  Stand second;
  drive(second, 3, 20);
  state::restore(second.model, saved);
  drive(second, 500, 1000);
  EXPECT_EQ(state::first_difference(straight.model, second.model), std::nullopt);
  EXPECT_EQ(straight.outputs.power_w, second.outputs.power_w);
}

TEST(Motors, InputsOutsideTheirRangeAreRefused) {
  const auto message = [](const auto& spoil) {
    Stand stand;
    spoil(stand.inputs);
    return error_of([&] { stand.step(kMillisecond); });
  };
  EXPECT_THAT(message([](Inputs& in) { in.rotor_command[1] = 1.01; }), HasSubstr("rotor[2].command = 1.01"));
  EXPECT_THAT(message([](Inputs& in) { in.rotor_command[0] = std::numeric_limits<double>::quiet_NaN(); }),
              HasSubstr("rotor[1].command = nan"));
  EXPECT_THAT(message([](Inputs& in) { in.bus_voltage_v = -1; }), HasSubstr("bus.voltage = -1 V must be >= 0"));
  EXPECT_THAT(message([](Inputs& in) { in.body_mass_kg = -0.04; }), HasSubstr("body.mass = -0.04 kg must be >= 0"));
  EXPECT_THAT(message([](Inputs& in) { in.air_density_kg_per_m3 = 0; }),
              HasSubstr("air.density = 0 kg/m3 must be >= 1e-40 and <= 1e+40"));
}

TEST(Motors, InputsOfWhichNoPowerCouldBeANumberAreRefused) {
  const auto message = [](const auto& spoil) {
    Stand stand;
    stand.command(1);
    spoil(stand.inputs);
    return error_of([&] { stand.step(kMillisecond); });
  };
  EXPECT_THAT(message([](Inputs& in) { in.bus_voltage_v = 1e200; }),
              HasSubstr("bus.voltage = 1e+200 V must be >= 0 and <= 1e+40"));
  EXPECT_THAT(message([](Inputs& in) { in.body_mass_kg = 1e300; }), HasSubstr("body.mass = 1e+300 kg"));
  EXPECT_THAT(message([](Inputs& in) { in.air_density_kg_per_m3 = 1e300; }), HasSubstr("air.density = 1e+300 kg/m3"));
  EXPECT_THAT(message([](Inputs& in) { in.air_density_kg_per_m3 = 1e-310; }), HasSubstr("air.density = 1e-310 kg/m3"));
  EXPECT_THAT(message([](Inputs& in) { in.body_speed_m_per_s = 1e300; }), HasSubstr("body.speed = 1e+300 m/s"));
  EXPECT_THAT(message([](Inputs& in) { in.body_climb_m_per_s = -1e300; }), HasSubstr("body.climb = -1e+300 m/s"));
}

TEST(Motors, GivesFiniteNumbersWithinTheLimits) {
  Parameters parameters;
  parameters.inflow = true;
  constexpr double kMost = 1e40;
  for (const double density : {1 / kMost, kMost}) {
    for (const double climb : {-kMost, kMost}) {
      Stand stand(parameters);
      stand.command(1);
      stand.inputs.air_density_kg_per_m3 = density;
      stand.inputs.body_mass_kg = kMost;
      stand.inputs.body_speed_m_per_s = kMost;
      stand.inputs.body_climb_m_per_s = climb;
      for (const double voltage : {kMost, 3.7, 0.0, kMost}) {  // up, down and up again
        stand.inputs.bus_voltage_v = voltage;
        for (const std::int64_t step_ns : {kMillisecond, 1'000'000 * kMillisecond}) {
          stand.step(step_ns);
          EXPECT_TRUE(std::isfinite(stand.outputs.power_w)) << density << ' ' << climb << ' ' << voltage;
          EXPECT_TRUE(std::isfinite(stand.outputs.bench_power_w));
          EXPECT_TRUE(std::isfinite(stand.outputs.inflow_power_w));
          EXPECT_TRUE(std::isfinite(stand.outputs.hover_power_w));
          EXPECT_TRUE(std::isfinite(stand.outputs.propel_power_w));
          EXPECT_TRUE(std::isfinite(stand.outputs.rotor_thrust_n[0]));
        }
      }
    }
  }
}

TEST(Motors, UnknownPowerModelIsRefused) {
  Parameters wrong;
  wrong.power_model = static_cast<PowerModel>(7);
  EXPECT_THAT(error_of([&] { Stand{wrong}; }), HasSubstr("power_model = 7"));
}

}  // namespace
}  // namespace mebots::motors
