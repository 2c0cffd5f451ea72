// SPDX-License-Identifier: Apache-2.0
#include "mebots/error.hpp"
#include "support/flight_rig.hpp"
#include "support/same_state.hpp"

#include <gtest/gtest.h>
#include <cstring>
#include <thread>

namespace mebots::world {
namespace {

using test::FlightRig;
using test::shipped_scene;

/// Compares all results of a run, except pointers.
testing::AssertionResult same(const FlightRig& a, const FlightRig& b) {
  if (const auto result = mebots::test::same_state(a.world, b.world); !result) return result;
  const bool is_same =
      a.outputs.rotor_command == b.outputs.rotor_command && a.outputs.drone_position_m == b.outputs.drone_position_m &&
      a.outputs.range_down_m == b.outputs.range_down_m &&
      a.outputs.drone_path_length_m == b.outputs.drone_path_length_m &&
      a.outputs.drone_phase == b.outputs.drone_phase && a.outputs.drone_yaw_rad == b.outputs.drone_yaw_rad &&
      a.outputs.gate_lateral_error_m == b.outputs.gate_lateral_error_m &&
      a.outputs.gate_passed == b.outputs.gate_passed && a.outputs.gate_crossed == b.outputs.gate_crossed &&
      a.outputs.gate_stuck == b.outputs.gate_stuck && a.outputs.gate_turned_back == b.outputs.gate_turned_back;
  return is_same ? testing::AssertionSuccess() : testing::AssertionFailure() << "the outputs differ";
}

test::RigParameters noisy() {
  test::RigParameters p = FlightRig::small_camera();
  p.range_noise_m = 0.01;
  p.camera_noise = 3.0;
  p.start_offset_m = {3.0, 0.355, 0.0};  // 5 mm outside of the clear opening: it will touch the gate
  return p;
}

/// Sets the set-points of the next step. The flight has pictures, a take-off, a contact with the gate and a landing.
void script(FlightRig& rig) {
  const double t = rig.time_s();
  rig.inputs.setpoint_mode = t < 5.0 ? FlightMode::take_off : t < 14.0 ? FlightMode::fly : FlightMode::land;
  rig.inputs.setpoint_velocity_x_m_per_s = 0.3;
  rig.inputs.setpoint_velocity_y_m_per_s = t > 11.0 ? -0.1 : 0.0;
  rig.inputs.setpoint_yaw_rate_rad_per_s = t > 6.0 && t < 6.5 ? 0.02 : 0.0;
  rig.inputs.wind_velocity_m_per_s = {0.1, 0.2, 0.0};
  rig.inputs.camera_trigger = static_cast<std::int32_t>(t / 0.1);
}

void fly_about(FlightRig& rig, int steps) {
  for (int i = 0; i < steps; ++i) {
    script(rig);
    rig.step();
  }
}

constexpr int kSteps = 10'000;  // 20 s

TEST(WorldState, ARestoredRunContinuesWithTheSameBitsAlsoDuringContact) {
  FlightRig straight(shipped_scene("gate_easy"), noisy());
  // Saves states during the climb, in front of the gate, in contact with the gate, behind the gate, during the landing,
  // and after the landing.
  std::vector<std::unique_ptr<FlightRig>> restored;
  for (const int cut : {700, 4000, 5300, 5800, 7600, 9800}) {
    fly_about(straight, cut - static_cast<int>(straight.time_ns / 2'000'000));
    auto& other = *restored.emplace_back(std::make_unique<FlightRig>(shipped_scene("gate_easy"), noisy()));
    other.inputs = straight.inputs;
    other.outputs = straight.outputs;
    other.outputs.camera_frame = {};
    other.rotors = straight.rotors;
    other.time_ns = straight.time_ns;
    state::restore(other.world, state::save(straight.world));
    EXPECT_TRUE(same(straight, other)) << "right after the cut at step " << cut;
    const auto frame = other.outputs.camera_frame.bytes();
    EXPECT_TRUE(std::equal(frame.begin(), frame.end(), straight.outputs.camera_frame.bytes().begin()));
    fly_about(other, kSteps - cut);
  }
  fly_about(straight, kSteps - static_cast<int>(straight.time_ns / 2'000'000));
  EXPECT_TRUE(straight.outputs.gate_touched);  // otherwise the test has no contact
  EXPECT_TRUE(straight.outputs.drone_landed);
  for (const auto& other : restored) EXPECT_TRUE(same(straight, *other));
}

TEST(WorldState, InterleavedInstancesGiveTheSameBitsAsAlone) {
  FlightRig alone(shipped_scene("gate_easy"), noisy());
  fly_about(alone, kSteps);
  FlightRig one(shipped_scene("gate_easy"), noisy());
  FlightRig two(shipped_scene("gate_easy"), noisy());
  FlightRig other(shipped_scene("empty"));
  for (int i = 0; i < kSteps; ++i) {
    fly_about(one, 1);
    fly_about(other, 1);
    fly_about(two, 1);
  }
  EXPECT_TRUE(same(one, alone));
  EXPECT_TRUE(same(two, alone));
}

TEST(WorldState, InstancesInThreadsGiveTheSameBitsAsAlone) {
  FlightRig alone(shipped_scene("gate_easy"), noisy());
  fly_about(alone, kSteps);
  std::vector<std::unique_ptr<FlightRig>> rigs;
  for (int i = 0; i < 3; ++i) rigs.push_back(std::make_unique<FlightRig>(shipped_scene("gate_easy"), noisy()));
  std::vector<std::thread> threads;
  for (auto& rig : rigs) threads.emplace_back([&rig] { fly_about(*rig, kSteps); });
  for (auto& thread : threads) thread.join();
  for (const auto& rig : rigs) EXPECT_TRUE(same(*rig, alone));
}

TEST(WorldState, OneStepAndTwoHalvesGiveTheSameBits) {
  // With equal inner steps and constant inputs, the result must not depend on the communication steps.
  FlightRig whole(shipped_scene("gate_easy"), noisy());
  FlightRig halves(shipped_scene("gate_easy"), noisy());
  for (auto* rig : {&whole, &halves}) {
    rig->inputs.setpoint_mode = FlightMode::take_off;
    rig->inputs.rotor_thrust_n = {0.101, 0.1, 0.1, 0.101};
    rig->inputs.rotor_torque_n_m = {7e-4, 7.1e-4, 7e-4, 7e-4};
  }
  for (std::int64_t t_ns = 0; t_ns < 500'000'000; t_ns += 4'000'000) {
    whole.world.step(t_ns, 4'000'000);
    halves.world.step(t_ns, 2'000'000);
    halves.world.step(t_ns + 2'000'000, 2'000'000);
    ASSERT_TRUE(same(whole, halves)) << "at " << t_ns << " ns";
  }
}

TEST(WorldState, AFinerInnerStepConvergesWithFirstOrder) {
  // The drone climbs and rotates for two seconds under constant, slightly uneven thrust and wind, without a stabiliser.
  const auto end_of = [](double inner_step_s) {
    test::RigParameters p = FlightRig::small_camera();
    p.physics_step_s = inner_step_s;
    p.start_offset_m = {0.0, 0.0, 20.0};
    FlightRig rig(shipped_scene("empty"), p);
    rig.inputs.rotor_thrust_n = {0.1, 0.1, 0.1000001, 0.1000002};
    rig.inputs.rotor_torque_n_m = {7e-4, 7.01e-4, 7e-4, 7e-4};
    rig.inputs.wind_velocity_m_per_s = {1.0, 0.5, 0.0};
    for (std::int64_t t_ns = 0; t_ns < 2'000'000'000; t_ns += 4'000'000) rig.world.step(t_ns, 4'000'000);
    return Eigen::Vector3d(rig.outputs.drone_position_m.data());
  };
  const Eigen::Vector3d fine = end_of(1.25e-4);
  const double at_2ms = (end_of(2e-3) - fine).norm();
  const double at_1ms = (end_of(1e-3) - fine).norm();
  // The errors are relative to the result with the finest step, 1/8 ms. For a method of first order, the expected
  // ratio is (2 - 1/8) / (1 - 1/8) = 2.14.
  EXPECT_NEAR(at_2ms / at_1ms, 15.0 / 7.0, 0.1);
  EXPECT_LT(at_1ms, 0.02);
}

TEST(WorldState, IsRefusedWhenCutShort) {
  FlightRig rig(shipped_scene("gate_easy"));
  auto bytes = state::save(rig.world);
  bytes.resize(bytes.size() - 1);
  EXPECT_THROW(state::restore(rig.world, bytes), Error);
}

TEST(WorldState, IsRefusedIfTheSceneDiffers) {
  FlightRig with_gate(shipped_scene("gate_easy"));
  FlightRig without(shipped_scene("empty"));
  EXPECT_THROW(state::restore(without.world, state::save(with_gate.world)), Error);
}

}  // namespace
}  // namespace mebots::world
