// SPDX-License-Identifier: Apache-2.0
#include "support.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace mebots::battery {
namespace {

TEST(Cell, PublishedCellHasThePublishedElements) {
  // A second implementation of the formulas of Chen and Rincon-Mora (2006), independent of the product's code.
  const Cell cell = cell_named("chen_rincon_850");
  for (const double s : {0.05, 0.3, 0.7, 1.0}) {
    const Circuit c = cell.circuit_at(s);
    EXPECT_NEAR(c.open_circuit_v, -1.031 * std::exp(-35 * s) + 3.685 + 0.2156 * s - 0.1178 * s * s + 0.3201 * s * s * s,
                1e-14);
    EXPECT_NEAR(c.series_ohm, 0.1562 * std::exp(-24.37 * s) + 0.07446, 1e-14);
    EXPECT_NEAR(c.pair1_ohm, 0.3208 * std::exp(-29.14 * s) + 0.04669, 1e-14);
    EXPECT_NEAR(c.pair1_farad, -752.9 * std::exp(-13.51 * s) + 703.6, 1e-10);
    EXPECT_NEAR(c.pair2_ohm, 6.603 * std::exp(-155.2 * s) + 0.04984, 1e-14);
    EXPECT_NEAR(c.pair2_farad, -6056 * std::exp(-27.12 * s) + 4475, 1e-9);
  }
}

TEST(Cell, ElementsKeepTheirValueBelowTheEndOfTheirFitAndTheVoltageDoesNot) {
  const Cell cell = cell_named("chen_rincon_850");
  const Circuit held = cell.circuit_at(0.02);
  const Circuit below = cell.circuit_at(0.001);
  EXPECT_EQ(held.series_ohm, below.series_ohm);
  EXPECT_EQ(held.pair1_farad, below.pair1_farad);
  EXPECT_EQ(held.pair2_farad, below.pair2_farad);
  EXPECT_GT(below.pair2_farad, 0);
  EXPECT_LT(below.open_circuit_v, held.open_circuit_v - 0.3);
}

TEST(Cell, ScaledCellsKeepTheTimeConstantsOfThePublishedCell) {
  const Circuit published = cell_named("chen_rincon_850").circuit_at(0.5);
  for (const char* name : {"bitcraze_250", "ufx_250", "cyclone_300", "lipol_350"}) {
    const Circuit scaled = cell_named(name).circuit_at(0.5);
    // The tolerances cover the rounding of resistance_factor and capacitance_factor, which have six decimals in the
    // cell files.
    EXPECT_NEAR(scaled.pair1_ohm * scaled.pair1_farad, published.pair1_ohm * published.pair1_farad, 1e-4);
    EXPECT_NEAR(scaled.pair2_ohm * scaled.pair2_farad, published.pair2_ohm * published.pair2_farad, 1e-3);
  }
}

TEST(Cell, ThePapersFourCellsHaveThePapersMassAndCapacity) {
  const auto is = [](const char* name, double capacity_mah, double mass_g) {
    const Cell cell = cell_named(name);
    EXPECT_DOUBLE_EQ(cell.capacity_c, capacity_mah * 3.6) << name;
    EXPECT_DOUBLE_EQ(cell.mass_kg, mass_g / 1000) << name;
  };
  is("bitcraze_250", 250, 7.1);
  is("ufx_250", 250, 5.8);
  is("cyclone_300", 300, 8.1);
  is("lipol_350", 350, 9.2);
}

TEST(Cell, CurrentSolvesThePowerBalanceOfTheSeriesResistance) {
  for (const double power_w : {-5.0, -1e-9, 0.0, 1e-9, 3.0, 9.0, 30.0}) {
    const double current_a = terminal_current_a(4.0, 0.1, power_w);
    EXPECT_NEAR((4.0 - 0.1 * current_a) * current_a, power_w, 1e-13 * std::max(1.0, std::abs(power_w)));
    EXPECT_LE(current_a, 20);  // the smaller root: at most E / (2 R), the current at the greatest power
  }
  // The current is P / E plus the next term of its series, R P^2 / E^3. No digit is lost by cancellation.
  EXPECT_NEAR(terminal_current_a(4.0, 0.1, 1e-12), 2.5e-13 + 0.1 * 1e-24 / 64, 1e-28);
  EXPECT_DOUBLE_EQ(terminal_current_a(4.0, 0.1, 41), 20);  // beyond E^2 / (4 R) = 40 W
}

TEST(Cell, PowerLimitIsThePowerAtTheCutOffOrTheGreatestPower) {
  const double at_cut_off = power_limit_w(4.0, 0.1, 3.0);
  EXPECT_DOUBLE_EQ(4.0 - 0.1 * terminal_current_a(4.0, 0.1, at_cut_off), 3.0);
  EXPECT_DOUBLE_EQ(power_limit_w(4.0, 0.1, 0.5), 40);
  EXPECT_LT(power_limit_w(2.7, 0.1, 2.8), 0);  // even an open circuit does not keep the voltage above the limit
}

TEST(CellCalibration, MovesQuantitiesWithinTheirIntervals) {
  const auto path = kParams / "cells" / "bitcraze_250_flights.json";
  const Cell as_stated = load_cell(path);
  const Cell worst = load_cell(path, {.resistance = 1, .capacity = -1, .cut_off_voltage = 1, .cut_off_delay = -1});
  EXPECT_DOUBLE_EQ(worst.series_ohm(0.5) / as_stated.series_ohm(0.5), 1.44);
  EXPECT_DOUBLE_EQ(worst.pair1_ohm(0.5) * worst.pair1_farad(0.5),
                   as_stated.pair1_ohm(0.5) * as_stated.pair1_farad(0.5));
  EXPECT_DOUBLE_EQ(worst.capacity_c, 0.8 * as_stated.capacity_c);
  EXPECT_DOUBLE_EQ(worst.cut_off_voltage_v, 2.85);
  EXPECT_DOUBLE_EQ(worst.cut_off_delay_s, 0.115);
  EXPECT_TRUE(worst.warnings.empty());
  EXPECT_DOUBLE_EQ(load_cell(path, {.resistance = -0.5}).series_ohm(0.5) / as_stated.series_ohm(0.5), 0.915);
}

TEST(CellCalibration, WarnsWhereTheFileHasNoInterval) {
  const auto path = kParams / "cells" / "bitcraze_250.json";
  const Cell cell = load_cell(path, {.resistance = 1});
  EXPECT_EQ(cell.series_ohm(0.5), load_cell(path).series_ohm(0.5));
  ASSERT_EQ(cell.warnings.size(), 1U);
  EXPECT_THAT(cell.warnings.front(), testing::HasSubstr("calibration.resistance has no effect"));
}

TEST(CellCalibration, CapacityMovesInItsOwnIntervalIfItsFactorHasNone) {
  auto json = nlohmann::json::parse(std::ifstream(kParams / "cells" / "bitcraze_250.json"));
  json["capacity"]["interval"] = {810, 900};
  const auto path = std::filesystem::path(testing::TempDir()) / "printed.json";
  std::ofstream(path) << json;
  EXPECT_DOUBLE_EQ(load_cell(path, {.capacity = -1}).capacity_c, 810);
  EXPECT_DOUBLE_EQ(load_cell(path, {.capacity = 1}).capacity_c, 900);
}

TEST(CellCalibration, RefusesPositionsOutside) {
  const auto path = kParams / "cells" / "bitcraze_250_flights.json";
  EXPECT_THAT(error_of([&] { load_cell(path, {.capacity = 1.1}); }),
              testing::HasSubstr("calibration.capacity = 1.1 must be >= -1 and <= 1"));
}

}  // namespace
}  // namespace mebots::battery
