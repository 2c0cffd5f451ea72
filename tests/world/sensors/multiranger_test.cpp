// SPDX-License-Identifier: Apache-2.0
#include "sensors/multiranger.hpp"

#include "mebots/error.hpp"
#include "support/fleet.hpp"
#include "support/flight_rig.hpp"
#include "support/same_state.hpp"

#include <gmock/gmock.h>
#include <numbers>

namespace mebots::world {
namespace {

using test::FlightRig;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr std::int64_t kMultirangerPeriod_ns = 100'000'000;
const Eigen::Vector3d kOffset_m{0.0175, 0.0175, 0.005};

scene::Drone drone() {
  scene::Drone drone = test::shipped_drone("crazyflie");
  drone.multiranger->offset_m = kOffset_m;
  return drone;
}

Multiranger sensors_in(const scene::Scene& scene, const Ranging::Settings& settings = {}, std::uint64_t seed = 1) {
  const scene::Drone described = drone();
  return {std::make_shared<const RayCaster>(scene), described, *described.multiranger, settings, seed};
}

RigidState at(const Eigen::Vector3d& p_W_m, double yaw_rad = 0.0, double pitch_rad = 0.0, double roll_rad = 0.0) {
  RigidState state;
  state.p_WB_m = p_W_m;
  state.q_WB = rotation_of({roll_rad, pitch_rad, yaw_rad});
  return state;
}

Multiranger::Readings readings(const scene::Scene& scene, const RigidState& state, const Others& others = {}) {
  Multiranger sensors = sensors_in(scene);
  sensors.update(0, state, others);
  return sensors.readings_m();
}

/// A room with a wall on each side and a ceiling. All are boxes 0.2 m thick. The inner faces are 1.5 m east, 1.0 m
/// west, 0.8 m north and 0.5 m south of the origin. The ceiling is at 2.5 m.
scene::Scene room() {
  scene::Scene scene = test::shipped_scene("empty");
  scene.boxes = {
      {"east", {1.6, 0.0, 1.5}, {0.2, 10.0, 3.0}, 0.0, {}},     {"west", {-1.1, 0.0, 1.5}, {0.2, 10.0, 3.0}, 0.0, {}},
      {"north", {0.0, 0.9, 1.5}, {10.0, 0.2, 3.0}, 0.0, {}},    {"south", {0.0, -0.6, 1.5}, {10.0, 0.2, 3.0}, 0.0, {}},
      {"ceiling", {0.0, 0.0, 2.6}, {10.0, 10.0, 0.2}, 0.0, {}},
  };
  return scene;
}

TEST(Multiranger, MeasuresTheDistancesToTheWallsOfARoom) {
  const auto read_m = readings(room(), at({0.0, 0.0, 1.0}));
  EXPECT_NEAR(read_m[direction::front], 1.5 - kOffset_m.x(), 1e-12);
  EXPECT_NEAR(read_m[direction::back], 1.0 - kOffset_m.x(), 1e-12);
  EXPECT_NEAR(read_m[direction::left], 0.8 - kOffset_m.y(), 1e-12);
  EXPECT_NEAR(read_m[direction::right], 0.5 - kOffset_m.y(), 1e-12);
  EXPECT_NEAR(read_m[direction::up], 1.5 - kOffset_m.z(), 1e-12);
}

TEST(Multiranger, TurnsWithTheBody) {
  const auto turned_m = readings(room(), at({0.0, 0.0, 1.0}, 0.5 * std::numbers::pi));
  EXPECT_NEAR(turned_m[direction::front], 0.8 - kOffset_m.x(), 1e-12);
  EXPECT_NEAR(turned_m[direction::right], 1.5 - kOffset_m.y(), 1e-12);
  EXPECT_NEAR(turned_m[direction::back], 0.5 - kOffset_m.x(), 1e-12);

  // The ray to a wall at distance d has the length d / cos(angle) from the centre.
  const double yaw_rad = 0.3;
  const auto skew_m = readings(room(), at({0.0, 0.0, 1.0}, yaw_rad));
  EXPECT_NEAR(skew_m[direction::front], 1.5 / std::cos(yaw_rad) - kOffset_m.x(), 1e-12);
  EXPECT_NEAR(skew_m[direction::right], 0.5 / std::cos(yaw_rad) - kOffset_m.y(), 1e-12);

  const double pitch_rad = 0.4;  // nose down: front meets the east wall, back the west wall, up the ceiling
  const auto pitched_m = readings(room(), at({0.0, 0.0, 1.0}, 0.0, pitch_rad));
  EXPECT_NEAR(pitched_m[direction::front], 1.5 / std::cos(pitch_rad) - kOffset_m.x(), 1e-12);
  EXPECT_NEAR(pitched_m[direction::back], 1.0 / std::cos(pitch_rad) - kOffset_m.x(), 1e-12);
  EXPECT_NEAR(pitched_m[direction::up], 1.5 / std::cos(pitch_rad) - kOffset_m.z(), 1e-12);
  EXPECT_NEAR(pitched_m[direction::left], 0.8 - kOffset_m.y(), 1e-12);
}

TEST(Multiranger, MeetsTheGroundWhenItLooksDown) {
  const double pitch_rad = 1.2;
  const auto read_m = readings(test::shipped_scene("empty"), at({0.0, 0.0, 1.0}, 0.0, pitch_rad));
  EXPECT_NEAR(read_m[direction::front], 1.0 / std::sin(pitch_rad) - kOffset_m.x(), 1e-12);
}

TEST(Multiranger, MeetsCylindersGatesAndMeshes) {
  scene::Scene scene = test::shipped_scene("gate_easy");
  scene::Cylinder pillar;
  pillar.p_W_m = {2.0, 0.1, 1.0};
  pillar.radius_m = 0.3;
  pillar.height_m = 2.0;
  scene.cylinders.push_back(pillar);
  const auto& gate = scene.gates[0];
  scene::MeshThing ring;
  ring.p_W_m = {0.0, 2.0, 1.0};
  ring.yaw_rad = 0.5 * std::numbers::pi;  // its front faces south
  ring.mesh = std::make_shared<const scene::Mesh>(scene::ring(4, 0.2, 0.6, 0.04, {}));
  scene.meshes.push_back(ring);
  const auto read_m = readings(scene, at({0.0, 0.0, 1.0}));
  // The circle around (2, 0.1) with a radius of 0.3 meets y = 0 at x = 2 - sqrt(0.3^2 - 0.1^2).
  EXPECT_NEAR(read_m[direction::front], 2.0 - std::sqrt(0.08) - kOffset_m.x(), 1e-12);
  // The sides of the frame are 0.1 to 0.3 m from its middle. Through the opening, the sensor measures the distance to
  // the north wall.
  EXPECT_NEAR(read_m[direction::left], 4.0 - kOffset_m.y(), 1e-12);
  const auto beside_m = readings(scene, at({0.2, 0.0, 1.0}));
  EXPECT_NEAR(beside_m[direction::left], 2.0 - 0.02 - kOffset_m.y(), 1e-12);
  const RigidState before_gate = at(gate.p_W_m + Eigen::Vector3d(-0.5, 0.25, 0.0));
  EXPECT_NEAR(readings(scene, before_gate)[direction::front], 0.5 - 0.5 * gate.thickness_m - kOffset_m.x(), 1e-12);
}

TEST(Multiranger, SeesOtherDronesButNotItsOwn) {
  const scene::Scene scene = test::shipped_scene("empty");
  scene::Solid own;
  own.size_m = {0.1, 0.1, 0.03};
  own.radius_m = 0.5 * own.size_m.norm();
  own.p_W_m = {0.0, 0.0, 1.0};
  scene::Solid other = own;
  other.p_W_m = {1.0, 0.0, 1.0};
  const std::vector<scene::Solid> boxes{own, other};
  const auto read_m = readings(scene, at(own.p_W_m), {boxes, {}, 0});
  EXPECT_NEAR(read_m[direction::front], 0.95 - kOffset_m.x(), 1e-12);
  EXPECT_EQ(read_m[direction::back], 4.0);
}

TEST(Multiranger, HoldsItsSamplesForAPeriod) {
  Multiranger sensors = sensors_in(room());
  sensors.update(0, at({0.0, 0.0, 1.0}));
  const auto first = sensors.readings_m();
  sensors.update(kMultirangerPeriod_ns - 1, at({0.3, 0.0, 1.0}));
  EXPECT_EQ(sensors.readings_m(), first);
  sensors.update(kMultirangerPeriod_ns, at({0.3, 0.0, 1.0}));
  EXPECT_NEAR(sensors.readings_m()[direction::front], first[direction::front] - 0.3, 1e-12);
}

TEST(Multiranger, NoiseOfEachSensorHasTheRequestedDeviation) {
  constexpr double kNoise_m = 0.01;
  constexpr int kCount = 10'000;
  Multiranger sensors = sensors_in(room(), {.noise_m = kNoise_m}, 5);
  const auto truth_m = readings(room(), at({0.0, 0.0, 1.0}));
  Multiranger::Readings sum{};
  Multiranger::Readings squares{};
  double product = 0.0;
  for (int i = 0; i < kCount; ++i) {
    sensors.update(i * kMultirangerPeriod_ns, at({0.0, 0.0, 1.0}));
    Multiranger::Readings error;
    for (std::size_t k = 0; k < error.size(); ++k) {
      error[k] = sensors.readings_m()[k] - truth_m[k];
      sum[k] += error[k];
      squares[k] += error[k] * error[k];
    }
    product += error[0] * error[1];
  }
  for (std::size_t k = 0; k < sum.size(); ++k) {  // four standard errors
    EXPECT_NEAR(sum[k] / kCount, 0.0, 4.0 * kNoise_m / std::sqrt(kCount)) << direction::kWords[k];
    EXPECT_NEAR(std::sqrt(squares[k] / kCount), kNoise_m, 4.0 * kNoise_m / std::sqrt(2.0 * kCount));
  }
  EXPECT_NEAR(product / kCount, 0.0, 4.0 * kNoise_m * kNoise_m / std::sqrt(kCount)) << "front and back are correlated";
}

TEST(Multiranger, AConeMeasuresItsNearestSurface) {
  Multiranger sensors = sensors_in(room(), {.model = RangeModel::cone});
  constexpr double kYaw_rad = 0.2;  // less than half the field of view of 27 degrees
  double sum_m = 0.0;
  constexpr int kCount = 400;
  for (int i = 1; i <= kCount; ++i) {
    sensors.update(i * kMultirangerPeriod_ns, at({0.0, 0.0, 1.0}, kYaw_rad));
    sum_m += sensors.readings_m()[direction::front];
  }
  // The sensor is 1.5 m - 0.0175 cos(yaw) away from the wall. The nearest ray may deviate from the wall's normal by up
  // to 0.06 rad.
  EXPECT_NEAR(sum_m / kCount, 1.5 - kOffset_m.x() * std::cos(kYaw_rad), 0.004);
}

test::RigParameters with_multiranger() {
  test::RigParameters parameters = FlightRig::small_camera();
  parameters.multiranger_enabled = true;
  parameters.range_noise_m = 0.01;
  return parameters;
}

scene::Scene room_of_drone() {
  scene::Scene scene = room();
  scene.drone = drone();
  return scene;
}

TEST(Multiranger, IsOffByDefaultAndThenChangesNothing) {
  FlightRig off(room_of_drone());
  FlightRig on(room_of_drone(), with_multiranger());
  off.run(0.5);
  EXPECT_EQ(off.outputs.multiranger_m, Multiranger::Readings{});
  EXPECT_EQ(off.outputs.sensors_power_w, 0.0);
  EXPECT_GT(on.outputs.multiranger_m[direction::front], 0.0) << "there is a sample at the start";
  EXPECT_EQ(on.outputs.sensors_power_w, drone().multiranger->power_w);
  auto parameters = with_multiranger();
  parameters.multiranger_enabled = false;
  FlightRig without(room_of_drone(), parameters);
  on.run(0.5);
  without.run(0.5);
  EXPECT_EQ(on.outputs.range_down_m, without.outputs.range_down_m) << "the noise of other sensors has other numbers";
  EXPECT_EQ(on.outputs.drone_position_m, without.outputs.drone_position_m);
}

TEST(Multiranger, ARestoredRunContinuesWithTheSameBits) {
  FlightRig straight(room_of_drone(), with_multiranger());
  straight.run(0.333);
  FlightRig other(room_of_drone(), with_multiranger());
  other.continue_from(straight);
  straight.run(0.5);
  other.run(0.5);
  EXPECT_TRUE(mebots::test::same_state(straight.world, other.world));
  EXPECT_EQ(straight.outputs.multiranger_m, other.outputs.multiranger_m);
}

TEST(Multiranger, EachDroneHasItsOwnNoise) {
  test::Fleet fleet(room_of_drone(), with_multiranger(), {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}});
  EXPECT_NE(fleet.drones[0].outputs.multiranger_m[direction::up], fleet.drones[1].outputs.multiranger_m[direction::up]);
}

TEST(Multiranger, NeedsItsDataInTheDroneFile) {
  scene::Scene bare = room();
  bare.drone.multiranger.reset();
  EXPECT_THAT([&] { FlightRig(bare, with_multiranger()); },
              ThrowsMessage<Error>(HasSubstr("multiranger.enabled needs multiranger in the drone file")));
}

}  // namespace
}  // namespace mebots::world
