// SPDX-License-Identifier: Apache-2.0
#include "support/flight_rig.hpp"

#include <gmock/gmock.h>

namespace mebots::world {
namespace {

using test::FlightRig;
using test::shipped_scene;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

test::RigParameters starting_at(double x, double y, double z) {
  test::RigParameters p = FlightRig::small_camera();
  p.start_offset_m = {x, y, z};
  return p;
}

TEST(Flight, TakesOffFliesThroughTheGateAndLands) {
  FlightRig rig(shipped_scene("gate_easy"), starting_at(0.0, 0.1, 0.0));
  rig.take_off_and_fly();
  EXPECT_EQ(rig.outputs.drone_phase, FlightPhase::flying);
  EXPECT_NEAR(rig.altitude_m(), 1.0, 0.01);
  rig.inputs.setpoint_velocity_x_m_per_s = 0.3;
  rig.run(20.0);
  EXPECT_TRUE(rig.outputs.gate_reached);
  EXPECT_TRUE(rig.outputs.gate_crossed);
  EXPECT_TRUE(rig.outputs.gate_passed);
  EXPECT_FALSE(rig.outputs.gate_touched);
  EXPECT_FALSE(rig.outputs.gate_missed);
  EXPECT_FALSE(rig.outputs.gate_turned_back);
  EXPECT_FALSE(rig.outputs.gate_stuck);
  EXPECT_NEAR(rig.outputs.gate_lateral_error_m, -0.1, 1e-3);  // the gate's centre is 0.1 m to the left
  EXPECT_LT(rig.outputs.gate_distance_m, -0.3);
  rig.inputs.setpoint_mode = FlightMode::land;
  rig.run(8.0);
  EXPECT_EQ(rig.outputs.drone_phase, FlightPhase::landed);
  EXPECT_TRUE(rig.outputs.drone_landed);
  EXPECT_FALSE(rig.outputs.drone_crashed);
  for (const double command : rig.outputs.rotor_command) EXPECT_EQ(command, 0.0);
  EXPECT_NEAR(rig.altitude_m(), 0.0145, 1e-4);
  EXPECT_THAT(rig.events, ElementsAre(HasSubstr("take-off"), HasSubstr("flying"), HasSubstr("crossed gate 1"),
                                      HasSubstr("landing"), HasSubstr("landed")));
}

TEST(Flight, ClimbsAndSinksAtBoundedSpeed) {
  FlightRig rig;
  rig.inputs.setpoint_mode = FlightMode::take_off;
  rig.inputs.setpoint_altitude_m = 3.0;
  double fastest = 0.0;
  rig.run(10.0, [&] { fastest = std::max(fastest, rig.outputs.drone_velocity_m_per_s[2]); });
  EXPECT_NEAR(rig.altitude_m(), 3.0, 0.02);
  EXPECT_LT(fastest, 0.55);  // 0.5 m/s plus the overshoot of the loop
  EXPECT_GT(fastest, 0.45);
  rig.inputs.setpoint_mode = FlightMode::land;
  fastest = 0.0;
  rig.run(9.0, [&] { fastest = std::max(fastest, -rig.outputs.drone_velocity_m_per_s[2]); });
  EXPECT_GT(fastest, 0.27);
  EXPECT_LT(fastest, 0.35);
}

TEST(Flight, PathLengthIntegratesTheSpeed) {
  FlightRig rig;
  rig.take_off_and_fly();
  rig.inputs.setpoint_velocity_x_m_per_s = 0.5;
  rig.run(3.0);
  const double before_m = rig.outputs.drone_path_length_m;
  const double x_m = rig.outputs.drone_position_m[0];
  rig.run(4.0);
  // The flight is straight and level, so the path equals the distance, apart from millimetres of altitude.
  EXPECT_NEAR(rig.outputs.drone_path_length_m - before_m, rig.outputs.drone_position_m[0] - x_m, 1e-4);
}

TEST(Flight, BrakesAndHoldsItsPlaceWhenCommandedToLandAtSpeed) {
  FlightRig rig;
  rig.take_off_and_fly();
  rig.inputs.setpoint_velocity_x_m_per_s = 0.3;
  rig.run(5.0);
  const double x_m = rig.outputs.drone_position_m[0];
  rig.inputs.setpoint_mode = FlightMode::land;
  rig.run(8.0);
  EXPECT_TRUE(rig.outputs.drone_landed);
  EXPECT_GT(rig.outputs.drone_position_m[0], x_m);
  EXPECT_LT(rig.outputs.drone_position_m[0], x_m + 0.4);
}

TEST(Flight, LandsWithWindAndASaggingBus) {
  FlightRig rig;
  rig.rotors.sag = 0.85;
  rig.inputs.wind_velocity_m_per_s = {1.0, 1.0, 0.0};
  rig.take_off_and_fly();
  rig.inputs.setpoint_mode = FlightMode::land;
  rig.run(10.0);
  EXPECT_TRUE(rig.outputs.drone_landed);
  EXPECT_FALSE(rig.outputs.drone_crashed);
}

TEST(Flight, TakesOffAgainAfterLanding) {
  FlightRig rig;
  rig.take_off_and_fly();
  rig.inputs.setpoint_mode = FlightMode::land;
  rig.run(8.0);
  ASSERT_TRUE(rig.outputs.drone_landed);
  rig.take_off_and_fly();
  EXPECT_FALSE(rig.outputs.drone_landed);
  EXPECT_NEAR(rig.altitude_m(), 1.0, 0.02);
}

TEST(Flight, ALightTouchOfTheFrameIsSurvivedAndSeen) {
  // The drone flies 6 mm too far to the side at 0.3 m/s. Its corner hits the face of the frame's left side.
  FlightRig rig(shipped_scene("gate_easy"), starting_at(0.0, 0.2 + 0.160, 0.0));
  rig.take_off_and_fly();
  rig.inputs.setpoint_velocity_x_m_per_s = 0.3;
  while (!rig.outputs.gate_touched) rig.step();
  rig.run(0.2);
  EXPECT_FALSE(rig.outputs.drone_crashed);
  EXPECT_THAT(rig.events, Contains(HasSubstr("touched gate 1")));
  // The drone still flies: after it has moved back and to the centre, it passes through the gate.
  rig.inputs.setpoint_velocity_x_m_per_s = -0.3;
  rig.run(2.0);
  rig.inputs.setpoint_velocity_x_m_per_s = 0.0;
  rig.inputs.setpoint_velocity_y_m_per_s = -0.15;
  rig.run(1.5);
  rig.inputs.setpoint_velocity_x_m_per_s = 0.3;
  rig.inputs.setpoint_velocity_y_m_per_s = 0.0;
  rig.run(6.0);
  EXPECT_TRUE(rig.outputs.gate_passed);
  EXPECT_TRUE(rig.outputs.gate_touched);
  EXPECT_FALSE(rig.outputs.gate_stuck);
  EXPECT_FALSE(rig.outputs.drone_crashed);
  EXPECT_NEAR(rig.altitude_m(), 1.0, 0.05);
}

TEST(Flight, PassingTheGateOutsideIsAMiss) {
  FlightRig rig(shipped_scene("gate_easy"), starting_at(3.5, -1.0, 0.0));
  rig.take_off_and_fly();
  rig.inputs.setpoint_velocity_x_m_per_s = 0.5;
  rig.run(5.0);
  EXPECT_TRUE(rig.outputs.gate_missed);
  EXPECT_FALSE(rig.outputs.gate_crossed);
  EXPECT_FALSE(rig.outputs.gate_passed);
  EXPECT_NEAR(rig.outputs.gate_lateral_error_m, -1.2, 0.01);
  EXPECT_THAT(rig.events, Contains(HasSubstr("missed gate 1")));
}

TEST(Flight, AFastHitOfAWallIsACrash) {
  FlightRig rig(shipped_scene("gate_easy"));
  rig.take_off_and_fly(2.0);
  rig.inputs.setpoint_velocity_x_m_per_s = 2.0;
  rig.run(9.0);
  EXPECT_TRUE(rig.outputs.drone_crashed);
  EXPECT_EQ(rig.outputs.drone_phase, FlightPhase::crashed);
  EXPECT_THAT(rig.events, Contains(AllOf(HasSubstr("crash: hit east wall"), HasSubstr("at (9.9"))));
  for (const double command : rig.outputs.rotor_command) EXPECT_EQ(command, 0.0);
}

TEST(Flight, ADropFromTenCentimetresIsACrashAndFromThreeIsNot) {
  // The drone hits the ground at 1.4 m/s and at 0.77 m/s. The scene's limit is 1 m/s.
  FlightRig high(shipped_scene("empty"), starting_at(0.0, 0.0, 0.10));
  high.run(1.0);
  EXPECT_TRUE(high.outputs.drone_crashed);
  FlightRig low(shipped_scene("empty"), starting_at(0.0, 0.0, 0.03));
  low.run(1.0);
  EXPECT_FALSE(low.outputs.drone_crashed);
  EXPECT_TRUE(low.outputs.drone_landed);
}

TEST(Flight, TippingOverIsACrash) {
  FlightRig rig;
  rig.inputs.rotor_thrust_n = {0.0, 0.0, 0.15, 0.15};  // the left side only
  rig.inputs.setpoint_mode = FlightMode::fly;
  for (int i = 0; i < 1000 && !rig.outputs.drone_crashed; ++i) rig.world.step(i * 2'000'000, 2'000'000);
  EXPECT_TRUE(rig.outputs.drone_crashed);
  EXPECT_THAT(rig.events, Contains(HasSubstr("crash: tipped over")));
}

TEST(Flight, ADeadBusBringsTheDroneDown) {
  FlightRig rig;
  rig.take_off_and_fly();
  rig.rotors.sag = 0.0;
  rig.run(3.0);
  EXPECT_TRUE(rig.outputs.drone_crashed);
  EXPECT_THAT(rig.events, Contains(HasSubstr("crash: hit the ground")));
}

TEST(Flight, AStartInTheAirFliesAtOnce) {
  FlightRig rig(shipped_scene("empty"), starting_at(0.0, 0.0, 1.0));
  rig.rotors.thrust_n.fill(0.25 * 0.04 * 9.80665);
  rig.inputs.setpoint_mode = FlightMode::fly;
  rig.run(5.0);
  EXPECT_EQ(rig.outputs.drone_phase, FlightPhase::flying);
  EXPECT_NEAR(rig.altitude_m(), 1.0, 0.02);
}

TEST(Flight, OutputsOfTheStartAreThereBeforeTheFirstStep) {
  test::RigParameters p = starting_at(1.0, -0.5, 0.0);
  p.start_yaw_offset_rad = 0.3;
  const FlightRig rig(shipped_scene("gate_easy"), p);
  EXPECT_THAT(rig.outputs.drone_position_m, ElementsAre(1.0, -0.5, 0.0145));
  EXPECT_NEAR(rig.outputs.drone_yaw_rad, 0.3, 1e-15);
  EXPECT_EQ(rig.outputs.drone_phase, FlightPhase::on_ground);
  EXPECT_NEAR(rig.outputs.range_down_m, 0.0145, 1e-12);
  EXPECT_NEAR(rig.outputs.gate_distance_m, 4.0, 1e-12);
  EXPECT_DOUBLE_EQ(rig.outputs.drone_mass_kg, 0.04);
}

}  // namespace
}  // namespace mebots::world
