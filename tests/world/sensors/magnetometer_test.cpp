// SPDX-License-Identifier: Apache-2.0
#include "sensors/magnetometer.hpp"

#include "math/rotation.hpp"
#include "mebots/error.hpp"
#include "support/flight_rig.hpp"
#include "support/same_state.hpp"

#include <gmock/gmock.h>
#include <numbers>

namespace mebots::world {
namespace {

using test::FlightRig;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr std::int64_t kMagnetometerPeriod_ns = 50'000'000;
/// East, north, up.
const Eigen::Vector3d kWorldField{1.3e-6, 21.5e-6, -43.2e-6};

/// Returns a magnetometer without bias, noise and rounding.
scene::MagnetometerData exact_magnetometer() {
  scene::MagnetometerData data;
  data.period_s = 0.05;
  data.limit_t = 4e-4;
  return data;
}

Eigen::Vector3d reading(const scene::MagnetometerData& data, const Eigen::Quaterniond& q_WB) {
  Magnetometer sensor(data, kWorldField, 1);
  sensor.update(0, q_WB);
  return sensor.field_B_t();
}

void expect_near(const Eigen::Vector3d& value, const Eigen::Vector3d& expected) {
  EXPECT_LT((value - expected).norm(), 1e-18) << value.transpose() << " instead of " << expected.transpose();
}

TEST(Magnetometer, MeasuresTheFieldAlongTheBodysAxes) {
  constexpr double kQuarter_rad = 0.5 * std::numbers::pi;
  const double east = kWorldField.x();
  const double north = kWorldField.y();
  const double up = kWorldField.z();
  expect_near(reading(exact_magnetometer(), Eigen::Quaterniond::Identity()), kWorldField);
  // Nose to the north: x is north, y is west.
  expect_near(reading(exact_magnetometer(), yaw_rotation(kQuarter_rad)), {north, -east, up});
  // Nose down: x is down, z is east.
  expect_near(reading(exact_magnetometer(), rotation_of({0.0, kQuarter_rad, 0.0})), {-up, north, east});
  // Positive roll raises the left side: y is up, z is south.
  expect_near(reading(exact_magnetometer(), rotation_of({kQuarter_rad, 0.0, 0.0})), {east, up, -north});
}

TEST(Magnetometer, GivesTheHeadingOfALevelDrone) {
  for (const double yaw_rad : {-3.0, -1.0, 0.2, 2.5}) {
    const Eigen::Vector3d field_B_t = reading(exact_magnetometer(), yaw_rotation(yaw_rad));
    // The x axis of the world points to the east. The horizontal field is atan2(north, east) to the left of it. The
    // drone's yaw is this angle minus the angle of the measured field.
    const double heading_rad = std::atan2(kWorldField.y(), kWorldField.x()) - std::atan2(field_B_t.y(), field_B_t.x());
    EXPECT_NEAR(wrapped_rad(heading_rad - yaw_rad), 0.0, 1e-12);
  }
}

TEST(Magnetometer, RoundsToItsResolutionWithinItsRange) {
  scene::MagnetometerData data = exact_magnetometer();
  data.resolution_t = 1.4616e-8;
  data.limit_t = 3e-5;
  const Eigen::Vector3d field_B_t = reading(data, Eigen::Quaterniond::Identity());
  EXPECT_NEAR(std::remainder(field_B_t.y(), data.resolution_t), 0.0, 1e-18);
  EXPECT_NEAR(field_B_t.y(), kWorldField.y(), 0.5 * data.resolution_t);
  EXPECT_EQ(field_B_t.z(), -3e-5);
}

TEST(Magnetometer, NoiseOfEachAxisHasTheRequestedDeviation) {
  scene::MagnetometerData data = exact_magnetometer();
  data.noise_t = {3.2e-7, 3.2e-7, 4.1e-7};
  Magnetometer sensor(data, kWorldField, 9);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  constexpr int kCount = 20'000;
  for (int i = 0; i < kCount; ++i) {
    sensor.update(i * kMagnetometerPeriod_ns, Eigen::Quaterniond::Identity());
    const Eigen::Vector3d error = sensor.field_B_t() - kWorldField;
    sum += error;
    squares += error.cwiseAbs2();
  }
  for (int axis = 0; axis < 3; ++axis) {  // four standard errors
    EXPECT_NEAR(sum[axis] / kCount, 0.0, 4.0 * data.noise_t[axis] / std::sqrt(kCount));
    EXPECT_NEAR(std::sqrt(squares[axis] / kCount), data.noise_t[axis],
                4.0 * data.noise_t[axis] / std::sqrt(2.0 * kCount));
  }
}

TEST(Magnetometer, TheBiasOfEachAxisIsConstant) {
  scene::MagnetometerData data = exact_magnetometer();
  data.bias_t = 1e-4;
  data.limit_t = 1.0;
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  constexpr int kCount = 4000;
  for (int seed = 0; seed < kCount; ++seed) {
    Magnetometer sensor(data, kWorldField, static_cast<std::uint64_t>(seed));
    sensor.update(0, Eigen::Quaterniond::Identity());
    const Eigen::Vector3d first_t = sensor.field_B_t();
    sensor.update(kMagnetometerPeriod_ns, Eigen::Quaterniond::Identity());
    EXPECT_EQ(sensor.field_B_t(), first_t);
    squares += (first_t - kWorldField).cwiseAbs2();
  }
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(std::sqrt(squares[axis] / kCount), 1e-4, 4.0 * 1e-4 / std::sqrt(2.0 * kCount));
}

test::RigParameters with_both() {
  test::RigParameters parameters = FlightRig::small_camera();
  parameters.barometer_enabled = true;
  parameters.magnetometer_enabled = true;
  return parameters;
}

scene::Scene scene_of_drone() {
  scene::Scene scene = test::shipped_scene("empty");
  scene.drone = test::shipped_drone("crazyflie");
  return scene;
}

TEST(Magnetometer, ARestoredRunContinuesWithTheSameBits) {
  FlightRig straight(scene_of_drone(), with_both());
  straight.run(0.333);
  FlightRig other(scene_of_drone(), with_both());
  other.continue_from(straight);
  straight.run(0.5);
  other.run(0.5);
  EXPECT_TRUE(mebots::test::same_state(straight.world, other.world));
  EXPECT_EQ(straight.outputs.magnetometer_field_t, other.outputs.magnetometer_field_t);
  EXPECT_EQ(straight.outputs.barometer_pressure_pa, other.outputs.barometer_pressure_pa);
}

TEST(Magnetometer, RejectsAFieldThatIsNotFinite) {
  auto parameters = with_both();
  parameters.magnetic_field_t[1] = std::numeric_limits<double>::infinity();
  EXPECT_THAT([&] { FlightRig(scene_of_drone(), parameters); },
              ThrowsMessage<Error>(HasSubstr("magnetic.field.y = inf must be a finite number")));
}

}  // namespace
}  // namespace mebots::world
