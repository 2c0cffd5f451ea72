// SPDX-License-Identifier: Apache-2.0
// Tests which flights count as a passage of the gate. Uses the complete world with its contacts.
#include "support/flight_rig.hpp"

#include <gmock/gmock.h>
#include <cmath>

namespace mebots::world {
namespace {

using test::FlightRig;
using test::shipped_scene;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// Flights in gate_easy. start() places the drone `before_m` in front of the gate, and `left_m` to the left of the
/// gate's centre.
class Referee : public ::testing::Test {
 protected:
  static test::RigParameters start(double before_m, double left_m, double yaw_rad = 0.0) {
    test::RigParameters p = FlightRig::small_camera();
    p.start_offset_m = {5.0 - before_m, 0.2 + left_m, 0.0};
    p.start_yaw_offset_rad = yaw_rad;
    return p;
  }

  static void fly(FlightRig& rig, double forward_m_per_s, double seconds, double left_m_per_s = 0.0) {
    rig.inputs.setpoint_mode = FlightMode::fly;
    rig.inputs.setpoint_velocity_x_m_per_s = forward_m_per_s;
    rig.inputs.setpoint_velocity_y_m_per_s = left_m_per_s;
    rig.run(seconds);
  }

  static void land(FlightRig& rig) {
    rig.inputs.setpoint_mode = FlightMode::land;
    rig.run(8.0);
  }
};

TEST_F(Referee, ThroughTailFirstIsPassed) {
  FlightRig rig(shipped_scene("gate_easy"), start(1.0, 0.0, M_PI));
  rig.take_off_and_fly();
  fly(rig, -0.3, 6.0);
  land(rig);
  EXPECT_TRUE(rig.outputs.gate_passed);
  EXPECT_TRUE(rig.outputs.drone_landed);
}

TEST_F(Referee, ThroughAndBackIsNotPassed) {
  FlightRig rig(shipped_scene("gate_easy"), start(1.0, 0.0));
  rig.take_off_and_fly();
  fly(rig, 0.3, 6.0);
  EXPECT_TRUE(rig.outputs.gate_passed) << "so far it is behind";
  fly(rig, -0.3, 6.0);
  land(rig);
  EXPECT_TRUE(rig.outputs.drone_landed);
  EXPECT_TRUE(rig.outputs.gate_crossed);
  EXPECT_TRUE(rig.outputs.gate_turned_back);
  EXPECT_FALSE(rig.outputs.gate_passed);
  EXPECT_THAT(rig.events, Contains(HasSubstr("turned back: in front of gate 1 again")));
}

TEST_F(Referee, ThroughBackAndThroughAgainIsPassed) {
  FlightRig rig(shipped_scene("gate_easy"), start(0.5, 0.0));
  rig.take_off_and_fly();
  fly(rig, 0.3, 4.0);
  fly(rig, -0.3, 5.0);
  EXPECT_FALSE(rig.outputs.gate_passed);
  fly(rig, 0.3, 6.0);
  land(rig);
  EXPECT_TRUE(rig.outputs.gate_passed);
}

TEST_F(Referee, ThroughAndBackAroundTheFrameIsNotPassed) {
  FlightRig rig(shipped_scene("gate_easy"), start(0.5, 0.0));
  rig.take_off_and_fly();
  fly(rig, 0.4, 4.0);
  fly(rig, 0.0, 4.0, 0.4);
  fly(rig, -0.4, 6.0);
  land(rig);
  EXPECT_TRUE(rig.outputs.gate_turned_back);
  EXPECT_FALSE(rig.outputs.gate_touched);
  EXPECT_FALSE(rig.outputs.gate_passed);
}

TEST_F(Referee, HangingOnTheFrameIsStuck) {
  // The drone flies straight into the frame's left side, and continues to push for twenty seconds.
  FlightRig rig(shipped_scene("gate_easy"), start(0.5, 0.25));
  rig.take_off_and_fly();
  fly(rig, 0.2, 22.0);
  EXPECT_TRUE(rig.outputs.gate_stuck);
  EXPECT_FALSE(rig.outputs.gate_reached) << "its centre never came to the plane";
  land(rig);
  EXPECT_FALSE(rig.outputs.gate_passed);
  EXPECT_FALSE(rig.outputs.gate_crossed);
  EXPECT_THAT(rig.events, Contains(HasSubstr("stuck in gate 1")));
}

TEST_F(Referee, LandingInTheOpeningIsStuck) {
  // The drone lands as soon as its centre is behind the plane, so it lands on the lower beam.
  FlightRig rig(shipped_scene("gate_easy"), start(0.15, 0.0));
  rig.take_off_and_fly();
  fly(rig, 0.02, 0.0);
  while (!rig.outputs.gate_crossed) rig.step();
  land(rig);
  ASSERT_TRUE(rig.outputs.drone_landed);
  EXPECT_GT(rig.altitude_m(), 0.8);
  EXPECT_TRUE(rig.outputs.gate_stuck);
  EXPECT_FALSE(rig.outputs.gate_passed);
}

TEST_F(Referee, IgnoresTheMotionOfAWreck) {
  // The rotors stop behind the gate. The drone has crossed the gate, but does not complete the passage with a landing.
  FlightRig rig(shipped_scene("gate_easy"), start(0.5, 0.0));
  rig.take_off_and_fly();
  fly(rig, 0.3, 4.0);
  ASSERT_TRUE(rig.outputs.gate_crossed);
  rig.rotors.sag = 0.0;
  rig.run(3.0);
  EXPECT_TRUE(rig.outputs.drone_crashed);
  EXPECT_FALSE(rig.outputs.drone_landed);

  // The fast drone tips over shortly before the gate, and its body continues through the plane.
  FlightRig tipping(shipped_scene("gate_easy"), start(4.0, 0.0));
  tipping.take_off_and_fly();
  fly(tipping, 2.5, 0.0);
  while (tipping.outputs.gate_distance_m > 0.9) tipping.step();
  tipping.inputs.rotor_thrust_n = {0.0, 0.0, 0.15, 0.15};  // the left side only
  while (!tipping.outputs.drone_crashed) {
    tipping.world.step(tipping.time_ns, 2'000'000);
    tipping.time_ns += 2'000'000;
  }
  ASSERT_GT(tipping.outputs.gate_distance_m, 0.0) << testing::PrintToString(tipping.events);
  tipping.rotors.sag = 0.0;
  tipping.rotors.thrust_n.fill(0.0);
  tipping.run(1.0);
  EXPECT_LT(tipping.outputs.gate_distance_m, 0.0);
  EXPECT_FALSE(tipping.outputs.gate_reached);
}

}  // namespace
}  // namespace mebots::world
