// SPDX-License-Identifier: Apache-2.0
#include "sensors/barometer.hpp"

#include "support/flight_rig.hpp"

#include <gtest/gtest.h>

namespace mebots::world {
namespace {

using test::FlightRig;

constexpr std::int64_t kBarometerPeriod_ns = 20'000'000;

/// Returns a barometer without bias, noise and rounding.
scene::BarometerData exact_barometer() {
  scene::BarometerData data;
  data.period_s = 0.02;
  return data;
}

TEST(Barometer, FollowsTheTableOfTheStandardAtmosphere) {
  // ISO 2533:1975, U.S. Standard Atmosphere 1976: pressure over geopotential height.
  const Air air;
  EXPECT_DOUBLE_EQ(pressure_at(air, 0.0), 101325.0);
  EXPECT_NEAR(pressure_at(air, 1000.0), 89874.6, 0.05);
  EXPECT_NEAR(pressure_at(air, 5000.0), 54019.9, 0.05);
  EXPECT_NEAR(pressure_at(air, 11000.0), 22632.06, 0.05);
}

TEST(Barometer, PressureFallsByTheWeightOfTheAir) {
  // dp/dh = -g p / (R T): the hydrostatic equation with the ideal gas law, for air on a warm day.
  const Air air{98000.0, 303.15};
  constexpr double kStep_m = 0.5;
  for (const double height_m : {0.0, 10.0, 800.0}) {
    const double slope =
        (pressure_at(air, height_m + kStep_m) - pressure_at(air, height_m - kStep_m)) / (2.0 * kStep_m);
    const double temperature_k = air.temperature_k - 0.0065 * height_m;
    EXPECT_NEAR(slope, -9.80665 * pressure_at(air, height_m) / (287.05287 * temperature_k), 1e-6);
  }
}

TEST(Barometer, HoldsASampleForAPeriod) {
  Barometer sensor(exact_barometer(), {}, 1);
  sensor.update(0, 1.0);
  EXPECT_EQ(sensor.pressure_pa(), pressure_at({}, 1.0));
  sensor.update(kBarometerPeriod_ns - 1, 2.0);
  EXPECT_EQ(sensor.pressure_pa(), pressure_at({}, 1.0));
  sensor.update(kBarometerPeriod_ns, 2.0);
  EXPECT_EQ(sensor.pressure_pa(), pressure_at({}, 2.0));
}

TEST(Barometer, RoundsToItsResolution) {
  scene::BarometerData data = exact_barometer();
  data.resolution_pa = 0.33;
  Barometer sensor(data, {}, 1);
  sensor.update(0, 7.77);
  EXPECT_NEAR(std::remainder(sensor.pressure_pa(), 0.33), 0.0, 1e-9);
  EXPECT_NEAR(sensor.pressure_pa(), pressure_at({}, 7.77), 0.5 * 0.33);
}

TEST(Barometer, NoiseHasTheRequestedDeviationAndNoMean) {
  scene::BarometerData data = exact_barometer();
  data.noise_pa = 0.9;
  Barometer sensor(data, {}, 4);
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kCount = 20'000;
  for (int i = 0; i < kCount; ++i) {
    sensor.update(i * kBarometerPeriod_ns, 1.0);
    const double error = sensor.pressure_pa() - pressure_at({}, 1.0);
    sum += error;
    squares += error * error;
  }
  EXPECT_NEAR(sum / kCount, 0.0, 4.0 * data.noise_pa / std::sqrt(kCount));  // four standard errors
  EXPECT_NEAR(std::sqrt(squares / kCount), data.noise_pa, 4.0 * data.noise_pa / std::sqrt(2.0 * kCount));
}

TEST(Barometer, TheBiasIsConstantAndDrawnFromTheSeed) {
  scene::BarometerData data = exact_barometer();
  data.bias_pa = 50.0;
  double squares = 0.0;
  constexpr int kCount = 4000;
  for (int seed = 0; seed < kCount; ++seed) {
    Barometer sensor(data, {}, static_cast<std::uint64_t>(seed));
    sensor.update(0, 1.0);
    const double first_pa = sensor.pressure_pa();
    sensor.update(kBarometerPeriod_ns, 1.0);
    EXPECT_EQ(sensor.pressure_pa(), first_pa);
    squares += std::pow(first_pa - pressure_at({}, 1.0), 2);
  }
  EXPECT_NEAR(std::sqrt(squares / kCount), 50.0, 4.0 * 50.0 / std::sqrt(2.0 * kCount));
}

TEST(Barometer, MeasuresTheClimbOfADrone) {
  test::RigParameters parameters = FlightRig::small_camera();
  parameters.barometer_enabled = true;
  scene::Scene scene = test::shipped_scene("empty");
  scene.drone.barometer = exact_barometer();
  scene.drone.barometer->power_w = 0.002;
  FlightRig rig(scene, parameters);
  const double ground_pa = rig.outputs.barometer_pressure_pa;
  EXPECT_EQ(ground_pa, pressure_at({}, rig.altitude_m()));
  EXPECT_EQ(rig.outputs.sensors_power_w, 0.002);
  rig.take_off_and_fly();
  EXPECT_NEAR(rig.outputs.barometer_pressure_pa, pressure_at({}, rig.altitude_m()), 0.01);
  EXPECT_LT(rig.outputs.barometer_pressure_pa, ground_pa - 10.0);
}

}  // namespace
}  // namespace mebots::world
