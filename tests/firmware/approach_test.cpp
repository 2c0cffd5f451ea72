// SPDX-License-Identifier: Apache-2.0
// Tests navigator, pilot and policy with the real renderer, in a closed loop with a simple model of the drone. A
// set-point takes effect kStepsOfDelay after its picture.

#include "app/navigator.h"
#include "app/pilot.h"

#include "plain_drone.hpp"
#include "rendered_world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace mebots::firmware_test {
namespace {

constexpr double kApproachStep_s = 0.01;
constexpr int kStepsPerFrame = 10;
constexpr int kStepsOfDelay = 3;  // communication step, exposure, inference

struct Flight {
  Crossing crossing;
  bool done = false;
  double behind_m = 0.0;  ///< behind the gate's plane when the pilot finished
  double time_s = 0.0;
};

struct Mission {
  double cruise_m_s = 1.0 / 3.6;
  bool adaptive = false;
  double yaw_rate_scale_rad_s = 0.5;
};

Flight fly(const world::scene::Scene& scene, const BodyPose& start, const Mission& mission, std::uint64_t seed) {
  const auto micro = [](double value) { return static_cast<std::int32_t>(std::lround(value * 1e6)); };
  const auto& gate = scene.gates.at(0);
  Camera camera(scene);
  PlainDrone drone{start};
  pilot_t pilot;
  policy_t policy;
  policy_init(&policy, mission.adaptive, micro(mission.cruise_m_s), micro(mission.cruise_m_s));
  pilot_init(&pilot, &policy, micro(mission.yaw_rate_scale_rad_s));
  Flight flight;
  pilot_command_t command{0, 0};
  for (int frame = 0; frame < 3000 && !flight.done; ++frame) {
    const auto& pixels = camera.take(drone.pose, seed);
    for (int step = 0; step < kStepsPerFrame; ++step) {
      if (step == kStepsOfDelay) {
        const auto seen = finder_navigate(pixels.data(), camera.width(), camera.height());
        command = pilot_step(&pilot, &seen, micro(drone.velocity_m_s), micro(kApproachStep_s * kStepsPerFrame));
      }
      const Eigen::Vector3d before_m = drone.pose.p_WB_m;
      drone.move(kApproachStep_s, command.velocity_um_s * 1e-6, command.yaw_rate_urad_s * 1e-6);
      flight.crossing.look(gate, before_m, drone.pose);
    }
    flight.time_s += kApproachStep_s * kStepsPerFrame;
    flight.done = pilot.phase == PILOT_DONE;
  }
  flight.behind_m = drone.pose.p_WB_m.x() - gate.p_W_m.x();
  return flight;
}

void expect_clean_passage(const char* what, const Flight& flight, const world::scene::Gate& gate) {
  std::printf("[ measured ] %s: %.1f s, %.3f m left of the middle, %.1f deg to the axis, done %.2f m behind\n", what,
              flight.time_s, flight.crossing.lateral_m, flight.crossing.angle_rad / kDegree, flight.behind_m);
  EXPECT_TRUE(flight.crossing.clear_of(gate));
  EXPECT_TRUE(flight.done);
  // The pilot stops half a metre beyond the gate.
  EXPECT_GT(flight.behind_m, 0.25);
  EXPECT_LT(flight.behind_m, 0.75);
}

TEST(Approach, PassesTheEasyGateByVisionAloneAtThePapersThreeSpeeds) {
  const auto scene = load_scene("gate_easy");
  BodyPose start;
  start.p_WB_m = {scene.start.p_WB_m.x(), scene.start.p_WB_m.y(), 1.0};
  start.yaw_rad = scene.start.yaw_rad;
  for (const double km_h : {0.5, 1.0, 1.5}) {
    SCOPED_TRACE(km_h);
    Mission mission;
    mission.cruise_m_s = km_h / 3.6;
    expect_clean_passage("gate_easy", fly(scene, start, mission, 1), scene.gates[0]);
  }
}

TEST(Approach, PassesTheEasyGateFromSeededRandomStarts) {
  const auto scene = load_scene("gate_easy");
  Uniform uniform(2024);
  for (int i = 0; i < 12; ++i) {
    SCOPED_TRACE(i);
    BodyPose start;
    start.p_WB_m = {uniform(-0.5, 1.0), uniform(-0.6, 0.6), uniform(0.96, 1.04)};
    start.yaw_rad = uniform(-0.2, 0.2);
    expect_clean_passage("random start", fly(scene, start, {}, 100 + i), scene.gates[0]);
  }
}

TEST(Approach, FindsAGateBehindTheDroneBySearching) {
  const auto scene = load_scene("gate_easy");
  BodyPose start;
  start.p_WB_m = {1.0, 0.0, 1.0};
  start.yaw_rad = M_PI;
  expect_clean_passage("gate behind", fly(scene, start, {}, 5), scene.gates[0]);
}

TEST(Approach, PassesTheHardGateAtTheEdgeOfTheViewWithBothPolicies) {
  const auto scene = load_scene("gate_hard");
  BodyPose start;
  start.p_WB_m = {scene.start.p_WB_m.x(), scene.start.p_WB_m.y(), 1.0};
  start.yaw_rad = scene.start.yaw_rad;
  Mission mission;
  mission.cruise_m_s = 0.5 / 3.6;
  expect_clean_passage("gate_hard, 0.5 km/h", fly(scene, start, mission, 7), scene.gates[0]);
  mission.cruise_m_s = 1.0 / 3.6;
  mission.adaptive = true;
  expect_clean_passage("gate_hard, adaptive", fly(scene, start, mission, 7), scene.gates[0]);
}

}  // namespace
}  // namespace mebots::firmware_test
