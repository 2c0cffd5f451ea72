// SPDX-License-Identifier: Apache-2.0
// Tests robots other than drones, whose poses are inputs.
#include "mebots/error.hpp"
#include "support/fleet.hpp"
#include "support/same_state.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace mebots::world {
namespace {

using test::Fleet;
using test::FlightRig;
using test::RigParameters;
using test::shipped_scene;
using testing::Contains;
using testing::HasSubstr;

RigParameters with_robots(int count) {
  RigParameters p = FlightRig::small_camera();
  p.start_spacing_m = {};
  p.robot_count = count;
  return p;
}

/// Returns an empty world with robots that consist of one box.
scene::Scene scene_of_box(const Eigen::Vector3d& middle_m, const Eigen::Vector3d& size_m) {
  auto scene = shipped_scene("empty");
  scene::Box box;
  box.name = "block";
  box.p_W_m = middle_m;
  box.size_m = size_m;
  box.texture.light = 0.0;
  scene.robot = scene::Robot{"block", {box}, {}, {}};
  return scene;
}

/// Moves a robot along x from `x_m` at the start of the run.
void drive(Fleet& fleet, std::size_t robot, double x_m, double speed_m_per_s) {
  fleet.inputs.robot_position_x_m[robot] = x_m + speed_m_per_s * fleet.time_s();
  fleet.inputs.robot_velocity_x_m_per_s[robot] = speed_m_per_s;
}

TEST(Robots, ADroneLeavesARobotWithTheMomentumOfAContactWithAHeavyBody) {
  constexpr double kSpeed_m_per_s = 0.4;
  auto scene = scene_of_box(Eigen::Vector3d::Zero(), {0.3, 1.0, 4.0});
  scene.contact.friction = 0.0;
  const std::array sizes{scene.drone.body_size_m};
  RigidWorld bodies(scene, sizes, 1);
  bodies.set_mass(0, 0.03, inertia_for(scene.drone, 0.03));
  RigidState drone;
  drone.p_WB_m = {0.15 + 0.5 * scene.drone.body_size_m.x() + 0.02, 0.0, 1000.0};
  RigidState robot;
  robot.p_WB_m.z() = 1000.0;
  robot.v_WB_m_per_s.x() = kSpeed_m_per_s;
  bool touched = false;
  for (int step = 0; step < 200; ++step) {
    robot.p_WB_m.x() = 1e-3 * step * kSpeed_m_per_s;
    bodies.place(0, drone);
    bodies.move_robot(0, robot);
    bodies.step(1e-3, 0);
    drone = bodies.state(0);
    touched = touched || bodies.robot_touches(0);
  }
  EXPECT_TRUE(touched);
  // A body of infinite mass keeps its velocity V. The drone at rest gets the velocity (1 + e) V. Soft contacts increase
  // the bounce a little.
  EXPECT_NEAR(drone.v_WB_m_per_s.x() / kSpeed_m_per_s, 1.0 + scene.contact.bounce, 0.03);
  EXPECT_FALSE(bodies.robot_touches(0)) << "the drone left";
}

TEST(Robots, TheRangeSensorMeasuresToTheTopOfAMovingRobot) {
  const auto scene = shipped_scene("yard");
  constexpr double kRoofTop_m = 0.12;
  constexpr double kHalfLength_m = 0.15;
  Fleet fleet(scene, with_robots(1), {{0.0, 0.0, 2.0}});
  const double drone_x_m = fleet.drones[0].outputs.drone_position_m[0];
  int over_the_roof = 0;
  for (int sample = 1; sample <= 20; ++sample) {
    drive(fleet, 0, -1.0, 1.5);
    fleet.step(25'000'000);
    const double robot_x_m = fleet.outputs.robot_place_x_m[0];
    EXPECT_NEAR(robot_x_m, -1.0 + 1.5 * fleet.time_s(), 1e-12);
    const bool over = std::abs(robot_x_m - drone_x_m) <= kHalfLength_m;
    over_the_roof += over ? 1 : 0;
    const double height_m = fleet.drones[0].outputs.drone_position_m[2];
    EXPECT_NEAR(fleet.drones[0].outputs.range_down_m, height_m - (over ? kRoofTop_m : 0.0), 1e-9) << sample;
  }
  EXPECT_EQ(over_the_roof, 8) << "0.3 m at 1.5 m/s, sampled every 25 ms";
}

TEST(Robots, TheCameraShowsARobotAtItsPlaceAndYaw) {
  constexpr int kSize = 160;
  RigParameters p = with_robots(1);
  p.camera_width = kSize;
  p.camera_height = kSize;
  p.camera_noise = 0.0;
  Fleet fleet(scene_of_box({0.0, 0.0, 1.0}, {0.2, 0.4, 2.0}), p, {{-3.0, 0.0, 1.0}});
  const double camera_x_m = fleet.drones[0].outputs.drone_position_m[0] + p.camera_position_m[0];
  const auto black_columns = [&](double ahead_m, double yaw_rad) {
    fleet.inputs.robot_position_x_m[0] = camera_x_m + ahead_m;
    fleet.inputs.robot_yaw_rad[0] = yaw_rad;
    ++fleet.drones[0].inputs.camera_trigger;
    fleet.step(1'000'000);
    const auto picture = fleet.drones[0].outputs.camera_frame.bytes();
    const auto row = picture.subspan(kSize * (kSize / 2), kSize);
    return static_cast<double>(std::ranges::count(row, 0));
  };
  const double focal_px = 0.5 * kSize / std::tan(0.5 * p.camera_field_of_view_rad);
  EXPECT_NEAR(black_columns(1.0, 0.0), focal_px * 0.4 / 0.9, 1.0);
  EXPECT_NEAR(black_columns(2.0, 0.0), focal_px * 0.4 / 1.9, 1.0);
  EXPECT_NEAR(black_columns(1.0, std::acos(0.0)), focal_px * 0.2 / 0.8, 1.0);
  EXPECT_EQ(black_columns(-1.0, 0.0), 0.0) << "behind the drone";
}

TEST(Robots, ARobotThatRunsIntoADroneIsNamed) {
  Fleet fleet(scene_of_box({0.0, 0.0, 0.1}, {0.2, 0.2, 0.18}), with_robots(2), {{2.0, 0.0, 0.0}});
  fleet.inputs.robot_position_y_m[0] = 3.0;
  for (int i = 0; i < 250; ++i) {
    drive(fleet, 1, 1.5, 1.5);
    fleet.step();
  }
  EXPECT_TRUE(fleet.drones[0].outputs.drone_crashed);
  EXPECT_THAT(fleet.events, Contains(testing::MatchesRegex("drone\\[1\\].*crash: hit robot\\[2\\] with 1\\.500 m/s")));
}

TEST(Robots, EachReportsItsTouches) {
  auto scene = scene_of_box({0.0, 0.0, 0.1}, {0.2, 0.2, 0.18});
  scene::Box wall;
  wall.name = "wall";
  wall.p_W_m = {5.0, 0.0, 0.5};
  wall.size_m = {0.2, 1.0, 1.0};
  scene.boxes.push_back(wall);
  Fleet fleet(scene, with_robots(4), {{0.0, -3.0, 0.0}});
  fleet.inputs.robot_position_x_m = {4.81, 3.0, 3.19, 1.0};
  fleet.step();
  EXPECT_EQ(fleet.outputs.robot_touched, (std::array{true, true, true, false}));
  fleet.inputs.robot_position_x_m = {4.7, 3.0, 3.3, 1.0};
  fleet.step();
  EXPECT_EQ(fleet.outputs.robot_touched, (std::array{false, false, false, false}));
}

TEST(Robots, ADroneLandsOnARobot) {
  Fleet fleet(shipped_scene("yard"), with_robots(1), {{}});
  fleet.inputs.robot_position_x_m[0] = 0.0;
  auto& in = fleet.drones[0].inputs;
  in.setpoint_altitude_m = 0.6;
  const auto run_to = [&](double time_s) {
    while (fleet.time_s() < time_s) fleet.step();
  };
  in.setpoint_mode = FlightMode::take_off;
  run_to(4.0);
  in.setpoint_mode = FlightMode::fly;
  in.setpoint_velocity_x_m_per_s = 0.3;
  run_to(6.0);
  in.setpoint_velocity_x_m_per_s = 0.0;
  run_to(8.0);
  in.setpoint_mode = FlightMode::land;
  run_to(14.0);
  const auto& out = fleet.drones[0].outputs;
  EXPECT_TRUE(out.drone_landed);
  EXPECT_NEAR(out.drone_position_m[2], 0.12 + 0.5 * shipped_scene("yard").drone.body_size_m.z(), 1e-3);
  EXPECT_TRUE(fleet.outputs.robot_touched[0]);
}

TEST(Robots, ARestoredWorldContinuesWithTheSameBits) {
  const auto make = [] {
    return std::make_unique<Fleet>(shipped_scene("yard"), with_robots(2),
                                   std::vector<std::array<double, 3>>{{0.6, 0.0, 0.14}, {0.0, 1.0, 0.0}});
  };
  const auto run = [](Fleet& fleet, std::int64_t until_ns) {
    while (fleet.time_ns < until_ns) {
      drive(fleet, 0, -0.05, 0.1);
      fleet.inputs.robot_position_y_m[1] = 2.0;
      fleet.step();
    }
  };
  auto straight = make();
  run(*straight, 200'000'000);
  auto restored = make();
  for (std::size_t i = 0; i < 2; ++i) {
    restored->drones[i].inputs = straight->drones[i].inputs;
    restored->drones[i].outputs = straight->drones[i].outputs;
    restored->drones[i].outputs.camera_frame = {};
  }
  restored->rotors = straight->rotors;
  restored->time_ns = straight->time_ns;
  state::restore(restored->world, state::save(straight->world));
  run(*restored, 600'000'000);
  run(*straight, 600'000'000);
  EXPECT_TRUE(mebots::test::same_state(straight->world, restored->world));
}

TEST(Robots, BadInputIsNamed) {
  const auto error_of = [](auto act) -> std::string {
    try {
      act();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_THAT(error_of([] { Fleet(shipped_scene("empty"), with_robots(2), {{}}); }),
              HasSubstr("robot.count = 2, but scene \"empty\" describes no robot"));
  EXPECT_THAT(error_of([] {
                Fleet fleet(shipped_scene("yard"), with_robots(2), {{}});
                fleet.inputs.robot_yaw_rad[1] = std::nan("");
                fleet.step();
              }),
              HasSubstr("robot[2].yaw = nan"));
  EXPECT_THAT(error_of([] {
                Fleet(shipped_scene("yard"), with_robots(1), {{0.6, 0.0, 0.06}});
              }),
              HasSubstr("deep in robot[1]"));
  // ODE ends the process if a product of large numbers is not finite.
  EXPECT_THAT(error_of([] {
                Fleet fleet(shipped_scene("yard"), with_robots(2), {{}});
                fleet.inputs.robot_yaw_rate_rad_per_s[0] = 1.7e308;
                fleet.step();
              }),
              HasSubstr("an angular velocity of robot[1] [rad/s] is 1.7e+308, but must be below 1e+40"));
  EXPECT_THAT(error_of([] {
                Fleet fleet(shipped_scene("yard"), with_robots(2), {{}});
                fleet.inputs.robot_velocity_z_m_per_s[1] = 1e200;
                fleet.step();
              }),
              HasSubstr("a velocity of robot[2] [m/s] is 1e+200"));
}

TEST(Robots, TheViewNamesTheVariablesOfTheirPoses) {
  Fleet fleet(shipped_scene("yard"), with_robots(2), {{}});
  const auto view = nlohmann::json::parse(fleet.world.view());
  ASSERT_EQ(view["movers"].size(), 2U);
  EXPECT_EQ(view["movers"][1]["position"],
            nlohmann::json({"robot[2].place.x", "robot[2].place.y", "robot[2].place.z"}));
  EXPECT_EQ(view["movers"][1]["yaw"], "robot[2].heading");
  EXPECT_TRUE(std::ranges::any_of(view["faces"], [](const auto& face) { return face.value("mover", -1) == 1; }));
}

}  // namespace
}  // namespace mebots::world
