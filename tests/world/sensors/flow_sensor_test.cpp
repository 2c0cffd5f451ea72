// SPDX-License-Identifier: Apache-2.0
#include "sensors/flow_sensor.hpp"

#include "support/flight_rig.hpp"

#include <gtest/gtest.h>
#include <cmath>
#include <limits>

namespace mebots::world {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

scene::FlowData shipped_flow(double noise_pixels) {
  auto data = *test::shipped_scene("empty").drone.flow;
  data.noise_pixels = noise_pixels;
  return data;
}

struct Sum {
  double x = 0.0;
  double y = 0.0;
  int seen = 0;
};

/// Returns the sum of the sensor's counts over a time with constant motion.
Sum counted(FlowSensor& sensor, const RigidState& state, double distance_m, int milliseconds) {
  Sum sum;
  std::int64_t last = sensor.sample().number;
  for (int i = 1; i <= milliseconds; ++i) {
    sensor.update(i * kMillisecond, state, distance_m, 1e-3);
    if (sensor.sample().number == last) continue;
    last = sensor.sample().number;
    sum.x += sensor.sample().counts[0];
    sum.y += sensor.sample().counts[1];
    sum.seen += sensor.sample().seen ? 1 : 0;
  }
  return sum;
}

TEST(FlowSensor, CountsHowFarThePictureMovesAndLosesNothingToRounding) {
  FlowSensor sensor(shipped_flow(0.0), 1, 0);
  RigidState state;
  state.v_WB_m_per_s = {0.3, -0.05, 0.0};
  const Sum sum = counted(sensor, state, 1.5, 10'000);
  // The time is 10 s, and a count is a tenth of a pixel.
  EXPECT_NEAR(sum.x, 10.0 * 48.83 * 0.3 / 1.5 / 0.1, 1.0);
  EXPECT_NEAR(sum.y, 10.0 * 48.83 * -0.05 / 1.5 / 0.1, 1.0);
  EXPECT_EQ(sum.seen, 1000);
}

TEST(FlowSensor, SeesNothingAtNoDistance) {
  auto data = shipped_flow(0.0);
  data.nearest_m = 0.0;
  FlowSensor sensor(data, 1, 0);
  const Sum sum = counted(sensor, RigidState{}, 0.0, 100);  // 0 / 0
  EXPECT_EQ(sum.seen, 0);
  EXPECT_EQ(sum.x, 0.0);
}

TEST(FlowSensor, SeesItsOwnTurningAndAHeading) {
  FlowSensor sensor(shipped_flow(0.0), 1, 0);
  RigidState turning;
  turning.w_WB_W_rad_per_s = {0.2, 0.1, 0.0};
  const Sum sum = counted(sensor, turning, 1.0, 1'000);
  EXPECT_NEAR(sum.x, -48.83 * 0.1 / 0.1, 1.0);
  EXPECT_NEAR(sum.y, 48.83 * 0.2 / 0.1, 1.0);
  FlowSensor other(shipped_flow(0.0), 1, 0);
  RigidState west;
  west.q_WB = Eigen::AngleAxisd(1.5707963267948966, Eigen::Vector3d::UnitZ());
  west.v_WB_m_per_s = {0.0, 0.4, 0.0};  // forward in the sensor's frame
  EXPECT_NEAR(counted(other, west, 1.0, 1'000).x, 48.83 * 0.4 / 0.1, 1.0);
}

TEST(FlowSensor, MeasuresNothingTooNearTooFastOrWithoutASurface) {
  RigidState still;
  RigidState fast;
  fast.w_WB_W_rad_per_s = {0.0, 7.5, 0.0};
  FlowSensor near(shipped_flow(0.0), 1, 0);
  EXPECT_EQ(counted(near, still, 0.07, 100).seen, 0);
  FlowSensor quick(shipped_flow(0.0), 1, 0);
  EXPECT_EQ(counted(quick, fast, 1.0, 100).seen, 0);
  FlowSensor sky(shipped_flow(0.0), 1, 0);
  EXPECT_EQ(counted(sky, still, std::numeric_limits<double>::infinity(), 100).seen, 0);
  FlowSensor good(shipped_flow(0.0), 1, 0);
  EXPECT_EQ(counted(good, still, 1.0, 100).seen, 10);
}

TEST(FlowSensor, HasTheNoiseOfItsData) {
  FlowSensor sensor(shipped_flow(0.2), 3, 0);
  const RigidState still;
  double squares = 0.0;
  constexpr int kCount = 4000;
  for (int i = 1; i <= kCount; ++i) {
    sensor.update(i * 10 * kMillisecond, still, 1.0, 1e-2);
    squares += std::pow(sensor.sample().counts[0], 2);
  }
  // The noise has a standard deviation of 2 counts. With 4000 samples, its estimate is accurate to 1.1 %. Rounding, and
  // remainders that are added to the next sample, increase it a little.
  EXPECT_NEAR(std::sqrt(squares / kCount), 2.0, 0.12);
}

TEST(FlowSensor, IsThereForWhoAsks) {
  test::RigParameters p = test::FlightRig::small_camera();
  p.flow_enabled = true;
  test::FlightRig rig(test::shipped_scene("empty"), p);
  rig.take_off_and_fly();
  rig.inputs.setpoint_velocity_x_m_per_s = 0.5;
  rig.run(3.0);
  EXPECT_TRUE(rig.outputs.flow_seen);
  double mean = 0.0;
  constexpr int kSamples = 100;
  for (int i = 0; i < kSamples; ++i) {
    rig.run(0.01);
    mean += static_cast<double>(rig.outputs.flow_motion_x) / kSamples;
  }
  EXPECT_NEAR(mean, 0.01 * 48.83 * 0.5 / 0.1, 0.8);  // 0.2 from noise
}

}  // namespace
}  // namespace mebots::world
