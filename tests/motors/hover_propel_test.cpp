// SPDX-License-Identifier: Apache-2.0
#include "hover_propel.hpp"

#include "support.hpp"

#include <cmath>
#include <numbers>

namespace mebots::motors {
namespace {

TEST(HoverPropel, HoverPowerIsWeightTimesPitchTimesTurnsOverEfficiency) {
  const RotorData rotor = bench_rotor();
  const double weight_n = 0.040 * 9.80665;
  const double speed = std::sqrt(weight_n / 4 / rotor.thrust_coefficient);
  EXPECT_NEAR(hover_power_w(rotor, 0.040, 1.225), weight_n * 0.03 * speed / (2 * std::numbers::pi) / 0.5, 1e-12);
}

TEST(HoverPropel, HoverPowerGrowsWithMassToThreeHalvesAndFallsWithTheRootOfDensity) {
  const RotorData rotor = bench_rotor();
  EXPECT_NEAR(hover_power_w(rotor, 0.044, 1.225) / hover_power_w(rotor, 0.033, 1.225), std::pow(44.0 / 33, 1.5), 1e-12);
  EXPECT_NEAR(hover_power_w(rotor, 0.04, 0.9) / hover_power_w(rotor, 0.04, 1.2), std::sqrt(1.2 / 0.9), 1e-12);
}

TEST(HoverPropel, HoverPowerIsAboveTheIdealOfMomentumTheory) {
  // The ideal power is (m g)^1.5 / sqrt(2 rho A). The radius of a propeller is 23.55 mm.
  const double disc_m2 = 4 * std::numbers::pi * 0.02355 * 0.02355;
  const double ideal_w = std::pow(0.04 * 9.80665, 1.5) / std::sqrt(2 * 1.225 * disc_m2);
  EXPECT_GT(hover_power_w(bench_rotor(), 0.04, 1.225), ideal_w);
}

TEST(HoverPropel, PropelPowerIsWeightTimesSpeedOverEfficiencyAndLiftToDrag) {
  // D'Andrea's formula has kilogram, kilometre per hour, kilowatt and the constant 370.
  const double kilowatt = 0.04 * 1.0 / (370 * 0.5 * 3);
  EXPECT_NEAR(propel_power_w(bench_rotor(), 0.04, 1 / 3.6), kilowatt * 1000, 0.01 * kilowatt * 1000);  // 370 is rounded
}

}  // namespace
}  // namespace mebots::motors
