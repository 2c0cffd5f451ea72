// SPDX-License-Identifier: Apache-2.0
// Tests contacts and distances of objects: pitched boxes, cylinders, meshes, moving bodies.
#include "dynamics/rigid_world.hpp"
#include "math/rotation.hpp"
#include "mebots/error.hpp"
#include "scene/scene.hpp"
#include "sensors/range_sensor.hpp"
#include "support/flight_rig.hpp"
#include "support/one_body.hpp"
#include "support/same_state.hpp"
#include "support/shapes.hpp"

#include <gmock/gmock.h>
#include <cmath>
#include <thread>

namespace mebots::world {
namespace {

using Eigen::Vector3d;
using test::FlightRig;
using test::shipped_scene;

constexpr double kDroneMass_kg = 0.04;
constexpr double kGap_m = 1e-4;
const Vector3d kNothing = Vector3d::Zero();

RigidState at(const Vector3d& p_W_m, double yaw_rad = 0.0, double pitch_rad = 0.0) {
  RigidState state;
  state.p_WB_m = p_W_m;
  state.q_WB = rotation_of({0.0, pitch_rad, yaw_rad});
  return state;
}

bool touches(const scene::Scene& scene, const RigidState& state, std::int64_t time_ns = 0) {
  test::OneBody bodies(scene);
  const auto& found = bodies.touches_at(state, time_ns);
  return std::any_of(found.begin(), found.end(), [](const Touch& t) { return t.what == Touch::What::obstacle; });
}

/// Releases a drone, and returns its state after some seconds.
RigidState let_fall(const scene::Scene& scene, RigidState state, double seconds) {
  test::OneBody bodies(scene);
  bodies.set_mass(kDroneMass_kg, inertia_for(scene.drone, kDroneMass_kg));
  for (int i = 0; i < std::lround(seconds * 1e3); ++i) bodies.step(state, kNothing, kNothing, 1e-3, i * 1'000'000LL);
  return state;
}

scene::Box slope(double pitch_rad) {
  scene::Box box;
  box.name = "slope";
  box.size_m = {2.0, 2.0, 0.1};
  box.p_W_m = {0.0, 0.0, 2.0};
  box.pitch_rad = pitch_rad;
  return box;
}

TEST(PitchedBox, IsTouchedWhereItsTurnedSurfaceIs) {
  scene::Scene scene = shipped_scene("empty");
  scene.boxes = {slope(0.3)};
  // The nose is down by 0.3 rad, so the drone's underside is parallel to the slope.
  const Vector3d up_along = rotation_of({0.0, 0.3, 0.0}) * Vector3d::UnitZ();
  const auto over = [&](double height_m) {
    return at(scene.boxes[0].p_W_m + (0.05 + 0.0145 + height_m) * up_along, 0.0, 0.3);
  };
  EXPECT_FALSE(touches(scene, over(kGap_m)));
  EXPECT_TRUE(touches(scene, over(-kGap_m)));
}

TEST(PitchedBox, ADroneSlidesDownASlopeSteeperThanFriction) {
  scene::Scene scene = shipped_scene("empty");
  scene.boxes = {slope(0.5)};
  scene.contact.friction = 0.2;
  const Vector3d up_along = rotation_of({0.0, 0.5, 0.0}) * Vector3d::UnitZ();
  const RigidState start = at(scene.boxes[0].p_W_m + 0.065 * up_along, 0.0, 0.5);
  const RigidState end = let_fall(scene, start, 0.4);
  // a = g (sin - mu cos) along the slope, which descends towards +x. Soft contact and settling reduce the acceleration
  // slightly.
  const double expected = kGravity_m_per_s2 * (std::sin(0.5) - 0.2 * std::cos(0.5)) * 0.4;
  EXPECT_NEAR(end.v_WB_m_per_s.x(), expected * std::cos(0.5), 0.15 * expected);
  EXPECT_LT(end.p_WB_m.z(), start.p_WB_m.z());
}

TEST(Cylinder, IsTouchedAtItsRadiusFromAnySideAndAtItsEnds) {
  scene::Scene scene = shipped_scene("empty");
  scene::Cylinder pillar;
  pillar.p_W_m = {0.0, 0.0, 2.0};
  pillar.radius_m = 0.3;
  pillar.height_m = 1.0;
  scene.cylinders = {pillar};
  for (double side_rad = 0.0; side_rad < 6.2; side_rad += 0.5) {
    const Vector3d out{std::cos(side_rad), std::sin(side_rad), 0.0};
    const auto beside = [&](double gap_m) { return at(pillar.p_W_m + (0.3 + 0.046 + gap_m) * out, side_rad); };
    EXPECT_FALSE(touches(scene, beside(1e-3))) << side_rad;
    EXPECT_TRUE(touches(scene, beside(-1e-3))) << side_rad;
  }
  EXPECT_FALSE(touches(scene, at({0.0, 0.0, 2.5 + 0.0145 + kGap_m})));
  EXPECT_TRUE(touches(scene, at({0.0, 0.0, 2.5 + 0.0145 - kGap_m})));
}

TEST(Cylinder, CarriesADroneThatLandsOnIt) {
  scene::Scene scene = shipped_scene("empty");
  scene::Cylinder table;
  table.p_W_m = {0.0, 0.0, 0.4};
  table.radius_m = 0.5;
  table.height_m = 0.8;
  scene.cylinders = {table};
  const RigidState end = let_fall(scene, at({0.1, 0.1, 0.83}), 1.0);
  EXPECT_NEAR(end.p_WB_m.z(), 0.8145, 1e-4);  // penetration of the soft contact, some micrometres
  EXPECT_LT(end.v_WB_m_per_s.norm(), 1e-3);
}

TEST(MeshObstacle, IsTouchedWhereABoxOfItsShapeIs) {
  scene::Scene boxes = shipped_scene("empty");
  boxes.boxes = {slope(0.3)};
  scene::Scene meshes = shipped_scene("empty");
  scene::MeshThing thing;
  thing.p_W_m = boxes.boxes[0].p_W_m;
  thing.pitch_rad = 0.3;
  thing.mesh = test::box_mesh(boxes.boxes[0].size_m, {});
  meshes.meshes = {thing};
  int both = 0;
  for (double x = -1.2; x <= 1.2; x += 0.11) {
    for (double z = 1.55; z <= 2.45; z += 0.0137) {
      const RigidState state = at({x, 0.07, z}, 0.4);
      // A mesh is only a surface, so a drone inside of it touches nothing, unlike a drone inside of a box. Skips these
      // positions.
      const Vector3d inside = rotation_of({0.0, 0.3, 0.0}).conjugate() * (state.p_WB_m - thing.p_W_m);
      if (inside.cwiseAbs().x() < 1.0 && inside.cwiseAbs().z() < 0.05) continue;
      EXPECT_EQ(touches(meshes, state), touches(boxes, state)) << x << " " << z;
      both += touches(meshes, state) ? 1 : 0;
    }
  }
  EXPECT_GT(both, 20);
}

TEST(Terrain, CarriesADroneAtItsHeight) {
  scene::Scene scene = shipped_scene("empty");
  scene::MeshThing terrain;
  terrain.mesh = std::make_shared<const scene::Mesh>(
      scene::height_field({{0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}}, 0.7, {}));
  scene.meshes = {terrain};
  const RigidState end = let_fall(scene, at({0.66, 0.71, 0.53}), 1.0);
  EXPECT_NEAR(end.p_WB_m.z(), 0.5145, 1e-4);
  EXPECT_LT(end.v_WB_m_per_s.norm(), 1e-3);
}

TEST(MeshObstacle, GivesTheSameBitsInThreadsAsAlone) {
  scene::Scene scene = shipped_scene("empty");
  scene::MeshThing thing;
  thing.p_W_m = {0.0, 0.0, 0.3};
  thing.roll_rad = 0.4;
  thing.mesh = test::box_mesh({0.5, 0.5, 0.2}, {});
  scene.meshes = {thing};
  RigidState start = at({0.1, 0.1, 0.7}, 0.3);
  start.w_WB_W_rad_per_s = {3.0, -2.0, 1.0};
  const auto tumble = [&] { return let_fall(scene, start, 1.5); };
  const RigidState alone = tumble();
  std::array<RigidState, 4> results;
  std::vector<std::thread> threads;
  for (auto& result : results) threads.emplace_back([&] { result = tumble(); });
  for (auto& thread : threads) thread.join();
  for (const auto& result : results) {
    EXPECT_EQ(result.p_WB_m, alone.p_WB_m);
    EXPECT_EQ(result.q_WB.coeffs(), alone.q_WB.coeffs());
    EXPECT_EQ(result.w_WB_W_rad_per_s, alone.w_WB_W_rad_per_s);
  }
}

TEST(Path, GoesAtEvenSpeedAndBeginsAgain) {
  scene::Path path = test::shuttle({1.0, 0.0, 0.5});
  EXPECT_EQ(path.at(500'000'000).offset_W_m, Vector3d(0.25, 0.0, 0.125));
  EXPECT_EQ(path.at(500'000'000).velocity_W_m_per_s, Vector3d(0.5, 0.0, 0.25));
  EXPECT_EQ(path.at(3'000'000'000).velocity_W_m_per_s, Vector3d(-0.5, 0.0, -0.25));
  // The millionth cycle must be as exact as the first cycle.
  EXPECT_EQ(path.at(4'000'000'000LL * 1'000'000 + 500'000'000).offset_W_m, path.at(500'000'000).offset_W_m);
  path.repeat = false;
  EXPECT_EQ(path.at(9'000'000'000).velocity_W_m_per_s, kNothing);
  EXPECT_EQ(scene::Path{}.at(5).offset_W_m, kNothing);
}

TEST(MovingObstacle, IsWhereItsPathPlacesIt) {
  scene::Scene scene = shipped_scene("empty");
  scene::Box box;
  box.p_W_m = {0.0, 0.0, 1.0};
  box.size_m = {0.2, 0.2, 0.2};
  box.path = test::shuttle({1.0, 0.0, 0.0});
  scene.boxes = {box};
  for (const double time_s : {0.0, 0.7, 2.0, 3.1, 4.4}) {
    const auto time_ns = std::llround(time_s * 1e9);
    const double x = box.path.at(time_ns).offset_W_m.x();
    EXPECT_TRUE(touches(scene, at({x + 0.1 + 0.046 - kGap_m, 0.0, 1.0}), time_ns)) << time_s;
    EXPECT_FALSE(touches(scene, at({x + 0.1 + 0.046 + kGap_m, 0.0, 1.0}), time_ns)) << time_s;
  }
}

TEST(MovingObstacle, PushesWithItsOwnSpeedAndIsNotHeldUp) {
  scene::Scene scene = shipped_scene("empty");
  scene::Box box;
  box.p_W_m = {-0.2, 0.0, 5.0};
  box.size_m = {0.2, 0.5, 0.5};
  box.path = test::shuttle({2.0, 0.0, 0.0});  // 1 m/s
  scene.boxes = {box};
  scene.contact.bounce = 0.0;
  test::OneBody bodies(scene);
  bodies.set_mass(kDroneMass_kg, inertia_for(scene.drone, kDroneMass_kg));
  RigidState state = at({0.0, 0.0, 5.0});
  const Vector3d hover{0.0, 0.0, kDroneMass_kg * kGravity_m_per_s2};
  double closing = 0.0;
  for (int i = 0; i < 500; ++i) {
    for (const Touch& touch : bodies.step(state, hover, kNothing, 1e-3, i * 1'000'000LL)) {
      closing = std::max(closing, touch.closing_speed_m_per_s);
    }
  }
  EXPECT_NEAR(closing, 1.0, 1e-9);
  // The collision has no bounce. The contact also pushes the drone out with the speed soft_erp x depth / dt. The depth
  // is at most a millimetre.
  EXPECT_GE(state.v_WB_m_per_s.x(), 0.99);
  EXPECT_LE(state.v_WB_m_per_s.x(), 1.0 + scene.contact.soft_erp);
}

TEST(MovingObstacle, ARestoredFlightMeetsItWithTheSameBits) {
  scene::Scene scene = shipped_scene("empty");
  scene::Box box;
  box.name = "pusher";
  box.p_W_m = {-0.5, 0.0, 0.15};
  box.size_m = {0.2, 0.6, 0.3};
  box.path = test::shuttle({1.2, 0.1, 0.0});
  scene.boxes = {box};
  const auto run = [](FlightRig& rig, int steps) {
    for (int i = 0; i < steps; ++i) {
      rig.inputs.camera_trigger = static_cast<std::int32_t>(rig.time_s() / 0.1);
      rig.step();
    }
  };
  FlightRig straight(scene);
  run(straight, 1500);
  EXPECT_GT(straight.outputs.drone_position_m[0], 0.1) << "nothing pushed the drone";
  for (const int cut : {400, 500, 700}) {
    FlightRig first(scene);
    run(first, cut);
    FlightRig other(scene);
    other.inputs = first.inputs;
    other.rotors = first.rotors;
    other.time_ns = first.time_ns;
    state::restore(other.world, state::save(first.world));
    run(other, 1500 - cut);
    EXPECT_TRUE(mebots::test::same_state(other.world, straight.world)) << cut;
  }
}

class RangeOver : public testing::Test {
 protected:
  double from(const Vector3d& p_W_m, std::int64_t time_ns = 0) const {
    return test::sensor_in(scene_, {}, 1).distance_m(at(p_W_m), time_ns);
  }
  scene::Scene scene_ = shipped_scene("empty");
};

TEST_F(RangeOver, ASlopeIsItsDistanceStraightDown) {
  scene_.boxes = {slope(0.3)};
  // The slope's upper surface at x is 2 + 0.05 / cos - x tan.
  for (const double x : {-0.5, 0.0, 0.4}) {
    EXPECT_NEAR(from({x, 0.2, 3.0}), 1.0 - 0.05 / std::cos(0.3) + x * std::tan(0.3), 1e-12);
  }
}

TEST_F(RangeOver, ALyingCylinderFollowsItsCircle) {
  scene::Cylinder log;
  log.p_W_m = {0.0, 0.0, 1.0};
  log.radius_m = 0.4;
  log.height_m = 2.0;
  log.roll_rad = 0.5 * M_PI;  // along y
  scene_.cylinders = {log};
  for (const double x : {-0.39, -0.1, 0.0, 0.25}) {
    EXPECT_NEAR(from({x, 0.9, 2.0}), 1.0 - std::sqrt(0.16 - x * x), 1e-12);
  }
  EXPECT_NEAR(from({0.41, 0.9, 2.0}), 2.0, 1e-12);
  EXPECT_NEAR(from({0.0, 1.01, 2.0}), 2.0, 1e-12);
}

TEST_F(RangeOver, AMeshIsThatOfTheBoxOfItsShape) {
  scene_.boxes = {slope(0.3)};
  scene::Scene meshes = shipped_scene("empty");
  scene::MeshThing thing;
  thing.p_W_m = scene_.boxes[0].p_W_m;
  thing.pitch_rad = 0.3;
  thing.mesh = test::box_mesh(scene_.boxes[0].size_m, {});
  meshes.meshes = {thing};
  const RangeSensor sensor = test::sensor_in(meshes, {}, 1);
  for (double x = -1.2; x < 1.2; x += 0.017)
    EXPECT_NEAR(sensor.distance_m(at({x, 0.013, 3.0})), from({x, 0.013, 3.0}), 1e-9);
}

TEST_F(RangeOver, MeasuresAMovingObstacleWhileItPasses) {
  scene::Box box;
  box.p_W_m = {-1.0, 0.0, 0.5};
  box.size_m = {0.4, 0.4, 0.2};
  box.path = test::shuttle({1.0, 0.0, 0.0});
  scene_.boxes = {box};
  EXPECT_NEAR(from({0.0, 0.0, 2.0}, 0), 2.0, 1e-12);
  EXPECT_NEAR(from({0.0, 0.0, 2.0}, 2'000'000'000), 1.4, 1e-12);
}

}  // namespace
}  // namespace mebots::world
