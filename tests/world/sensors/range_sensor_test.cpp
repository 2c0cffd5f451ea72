// SPDX-License-Identifier: Apache-2.0
#include "sensors/range_sensor.hpp"

#include "support/flight_rig.hpp"

#include <gtest/gtest.h>

namespace mebots::world {
namespace {

RigidState at(double x, double y, double z, double roll_rad = 0.0) {
  RigidState state;
  state.p_WB_m = {x, y, z};
  state.q_WB = Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX());
  return state;
}

TEST(RangeSensor, ReadsTheHeightAboveGroundWhenLevel) {
  const RangeSensor sensor = test::sensor_in(test::shipped_scene("empty"), {}, 1);
  EXPECT_DOUBLE_EQ(sensor.distance_m(at(0.0, 0.0, 1.25)), 1.25);
}

TEST(RangeSensor, ReadsTheSlantedDistanceWhenTilted) {
  const RangeSensor sensor = test::sensor_in(test::shipped_scene("empty"), {}, 1);
  EXPECT_NEAR(sensor.distance_m(at(0.0, 0.0, 1.0, 0.5)), 1.0 / std::cos(0.5), 1e-12);
}

TEST(RangeSensor, SeesTheGatesBeamsBelow) {
  const auto scene = test::shipped_scene("gate_easy");
  const RangeSensor sensor = test::sensor_in(scene, {}, 1);
  const auto& gate = scene.gates[0].p_W_m;
  // In the opening, the top of the lower beam is at 0.83 m. Above the frame, its top is at 1.33 m.
  EXPECT_NEAR(sensor.distance_m(at(gate.x(), gate.y(), 1.0)), 1.0 - 0.83, 1e-12);
  EXPECT_NEAR(sensor.distance_m(at(gate.x(), gate.y(), 1.5)), 1.5 - 1.33, 1e-12);
  EXPECT_NEAR(sensor.distance_m(at(gate.x() - 0.016, gate.y(), 1.0)), 1.0, 1e-12);
}

TEST(RangeSensor, ReadsItsLimitWhereNothingIsNear) {
  const RangeSensor sensor = test::sensor_in(test::shipped_scene("empty"), {}, 1);
  EXPECT_EQ(sensor.distance_m(at(0.0, 0.0, 10.0)), 4.0);
  EXPECT_EQ(sensor.distance_m(at(0.0, 0.0, 1.0, 3.0)), 4.0);  // looks up
}

TEST(RangeSensor, HoldsASampleFor25Milliseconds) {
  RangeSensor sensor = test::sensor_in(test::shipped_scene("empty"), {.noise_m = 0.01}, 1);
  sensor.update(0, at(0.0, 0.0, 1.0));
  const double first = sensor.reading_m();
  sensor.update(24'999'999, at(0.0, 0.0, 2.0));
  EXPECT_EQ(sensor.reading_m(), first);
  sensor.update(25'000'000, at(0.0, 0.0, 2.0));
  EXPECT_NEAR(sensor.reading_m(), 2.0, 0.06);  // six standard deviations
}

TEST(RangeSensor, ANewSeedCountsFromTheNextSampleOn) {
  RangeSensor changed = test::sensor_in(test::shipped_scene("empty"), {.noise_m = 0.01}, 1);
  RangeSensor other = test::sensor_in(test::shipped_scene("empty"), {.noise_m = 0.01}, 2);
  changed.update(0, at(0.0, 0.0, 1.0));
  const double first = changed.reading_m();
  changed.reseed(2);
  changed.update(24'999'999, at(0.0, 0.0, 1.0));
  EXPECT_EQ(changed.reading_m(), first);
  for (auto* sensor : {&changed, &other}) sensor->update(25'000'000, at(0.0, 0.0, 1.0));
  EXPECT_EQ(changed.reading_m(), other.reading_m());
  EXPECT_NE(changed.reading_m(), first);
}

TEST(RangeSensor, NoiseHasTheRequestedDeviation) {
  RangeSensor sensor = test::sensor_in(test::shipped_scene("empty"), {.noise_m = 0.01}, 3);
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kCount = 20'000;
  for (int i = 0; i < kCount; ++i) {
    sensor.update(i * RangeSensor::kPeriod_ns, at(0.0, 0.0, 1.0));
    sum += sensor.reading_m() - 1.0;
    squares += (sensor.reading_m() - 1.0) * (sensor.reading_m() - 1.0);
  }
  EXPECT_NEAR(sum / kCount, 0.0, 4.0 * 0.01 / std::sqrt(kCount));  // four standard errors
  EXPECT_NEAR(std::sqrt(squares / kCount), 0.01, 4.0 * 0.01 / std::sqrt(2.0 * kCount));
}

TEST(RangeSensor, NeverReadsLessThanNothing) {
  RangeSensor sensor = test::sensor_in(test::shipped_scene("empty"), {.noise_m = 0.5}, 3);
  for (int i = 0; i < 100; ++i) {
    sensor.update(i * RangeSensor::kPeriod_ns, at(0.0, 0.0, 0.01));
    EXPECT_GE(sensor.reading_m(), 0.0);
  }
}

RigidState tilted(double height_m, double roll_rad) {
  return at(0.0, 0.0, height_m, roll_rad);
}

/// Returns mean and standard deviation of readings in mode `cone`.
std::pair<double, double> readings(const RigidState& state) {
  RangeSensor sensor = test::sensor_in(test::shipped_scene("empty"), {.model = RangeModel::cone}, 7);
  constexpr int kCount = 4000;
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 1; i <= kCount; ++i) {
    sensor.update(i * RangeSensor::kPeriod_ns, state);
    sum += sensor.reading_m();
    squares += sensor.reading_m() * sensor.reading_m();
  }
  const double mean = sum / kCount;
  return {mean, std::sqrt(std::max(0.0, squares / kCount - mean * mean))};
}

TEST(RangeCone, ATiltWithinTheFieldOfViewChangesLittle) {
  // The tilt of 0.2 rad is less than half the cone's angle, 0.2356 rad, so the cone contains the direction straight
  // down. The nearest ray misses this direction by 0.2356 - 0.2 = 0.036 rad, which increases the distance by less than
  // 0.1 %.
  EXPECT_NEAR(readings(tilted(1.0, 0.2)).first, 1.0, 0.004);
  // At larger angles, the nearest ray is at the edge of the cone.
  EXPECT_NEAR(readings(tilted(1.0, 0.5)).first, 1.0 / std::cos(0.5 - 0.2356), 0.002);
}

TEST(RangeCone, NoiseGrowsWithTheDistanceAsThePublishedModelSays) {
  const auto [near_m, near_noise_m] = readings(tilted(1.0, 0.0));
  // near_noise (1 + exp(-1.5 growth)) with growth = log(80) / 1.5 is 2.53 mm. Rounding to a millimetre adds 0.29 mm, as
  // a sum of squares.
  EXPECT_NEAR(near_noise_m, std::hypot(0.00253, 0.00029), 0.00012);
  EXPECT_NEAR(near_m, 1.0, 0.001);
  EXPECT_NEAR(readings(tilted(3.0, 0.0)).second, 0.0025 * (1.0 + std::pow(80.0, 0.5 / 1.5)), 0.0006);
}

TEST(RangeCone, ReadsWholeMillimetresAndItsLimit) {
  RangeSensor sensor = test::sensor_in(test::shipped_scene("empty"), {.model = RangeModel::cone}, 7);
  sensor.update(RangeSensor::kPeriod_ns, at(0.0, 0.0, 1.2345));
  EXPECT_NEAR(std::remainder(sensor.reading_m(), 0.001), 0.0, 1e-12);
  sensor.update(2 * RangeSensor::kPeriod_ns, at(0.0, 0.0, 9.0));
  EXPECT_EQ(sensor.reading_m(), 4.0);
}

}  // namespace
}  // namespace mebots::world
