// SPDX-License-Identifier: Apache-2.0
#include "mebots/error.hpp"
#include "support/flight_rig.hpp"

#include <gmock/gmock.h>
#include <cmath>

namespace mebots::world {
namespace {

using test::FlightRig;
using test::shipped_scene;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Returns the error message of a step after `spoil` has changed the inputs.
template <typename Spoil>
std::string step_error(Spoil spoil) {
  FlightRig rig;
  spoil(rig.inputs);
  try {
    rig.world.step(0, 2'000'000);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(WorldInputs, NamesTheRotorWhoseThrustIsNotANumber) {
  EXPECT_EQ(step_error([](test::RigInputs& in) { in.rotor_thrust_n[2] = NAN; }),
            "rotor[3].thrust = nan must be a finite number");
}

TEST(WorldInputs, RefusesNegativeTorque) {
  EXPECT_EQ(step_error([](test::RigInputs& in) { in.rotor_torque_n_m[0] = -1e-6; }),
            "rotor[1].torque = -1e-06 must be at least 0");
}

TEST(WorldInputs, RefusesWindThatIsNotFinite) {
  EXPECT_THAT(step_error([](test::RigInputs& in) { in.wind_velocity_m_per_s[1] = INFINITY; }),
              HasSubstr("wind.velocity.y = inf"));
}

TEST(WorldInputs, RefusesSetPointsThatAreNotNumbers) {
  EXPECT_THAT(step_error([](test::RigInputs& in) { in.setpoint_velocity_x_m_per_s = NAN; }),
              HasSubstr("setpoint.velocity.x"));
  EXPECT_THAT(step_error([](test::RigInputs& in) { in.setpoint_velocity_y_m_per_s = NAN; }),
              HasSubstr("setpoint.velocity.y"));
  EXPECT_THAT(step_error([](test::RigInputs& in) { in.setpoint_yaw_rate_rad_per_s = NAN; }),
              HasSubstr("setpoint.yaw_rate"));
  EXPECT_THAT(step_error([](test::RigInputs& in) { in.setpoint_altitude_m = NAN; }), HasSubstr("setpoint.altitude"));
}

TEST(WorldInputs, RefusesAModeThatDoesNotExist) {
  EXPECT_THAT(step_error([](test::RigInputs& in) { in.setpoint_mode = static_cast<FlightMode>(7); }),
              HasSubstr("setpoint.mode = 7 is not a mode"));
}

TEST(WorldInputs, RefusesACellOfNegativeMass) {
  EXPECT_THAT(step_error([](test::RigInputs& in) { in.cell_mass_kg = -0.01; }), HasSubstr("cell.mass = -0.01"));
}

TEST(WorldParameters, RefusesADroneOfNegativeMass) {
  test::RigParameters parameters = FlightRig::small_camera();
  parameters.drone_dry_mass_kg = -0.02;
  EXPECT_THAT([&] { FlightRig(shipped_scene("empty"), parameters); },
              ThrowsMessage<Error>(HasSubstr("drone.dry_mass = -0.02 must be at least 0")));
}

TEST(WorldParameters, RefusesAnInnerStepOfNothing) {
  test::RigParameters parameters = FlightRig::small_camera();
  parameters.physics_step_s = 0.0;
  EXPECT_THAT([&] { FlightRig(shipped_scene("empty"), parameters); },
              ThrowsMessage<Error>(HasSubstr("physics.step = 0 s must be from 1e-6")));
}

TEST(WorldParameters, RefusesAStartInsideAWall) {
  test::RigParameters parameters = FlightRig::small_camera();
  parameters.start_offset_m = {10.05, 0.0, 1.0};
  EXPECT_THAT([&] { FlightRig(shipped_scene("gate_easy"), parameters); },
              ThrowsMessage<Error>(HasSubstr("deep in east wall")));
}

TEST(WorldParameters, RefusesAStartBelowTheGround) {
  test::RigParameters parameters = FlightRig::small_camera();
  parameters.start_offset_m = {0.0, 0.0, -0.5};
  EXPECT_THAT([&] { FlightRig(shipped_scene("empty"), parameters); },
              ThrowsMessage<Error>(HasSubstr("deep in the ground")));
}

TEST(WorldMass, FollowsTheCell) {
  FlightRig rig;
  EXPECT_DOUBLE_EQ(rig.outputs.drone_mass_kg, 0.0329 + 0.0071);
  rig.inputs.cell_mass_kg = 0.0092;
  rig.step();
  EXPECT_DOUBLE_EQ(rig.outputs.drone_mass_kg, 0.0329 + 0.0092);
}

TEST(WorldAlone, RunsAtStartValuesWithAnyStepUpToATenthOfASecond) {
  for (const std::int64_t h_ns : {1'000'000LL, 2'000'000LL, 7'300'001LL, 100'000'000LL}) {
    FlightRig rig(shipped_scene("gate_easy"));
    for (std::int64_t t = 0; t < 2'000'000'000; t += h_ns) rig.world.step(t, h_ns);
    EXPECT_EQ(rig.outputs.drone_phase, FlightPhase::on_ground);
    EXPECT_NEAR(rig.outputs.drone_position_m[2], 0.0145, 1e-5);  // soft contact
    EXPECT_FALSE(rig.outputs.drone_crashed);
  }
}

TEST(WorldAlone, AStepOfADayIsTwoOfHalfADay) {
  // The step of 1e14 ns has 100,000 inner steps. Products in the computation of their times exceed 63 bits. A wrong
  // time would change the sensors' noise.
  constexpr std::int64_t kDay_ns = 100'000'000'000'000;
  test::RigParameters parameters = FlightRig::small_camera();
  parameters.physics_step_s = 1.0;
  parameters.range_noise_m = 0.001;
  parameters.imu_rate_noise_rad_per_s = 0.001;
  FlightRig whole(shipped_scene("empty"), parameters);
  FlightRig halves(shipped_scene("empty"), parameters);
  whole.world.step(0, kDay_ns);
  halves.world.step(0, kDay_ns / 2);
  halves.world.step(kDay_ns / 2, kDay_ns / 2);
  EXPECT_EQ(whole.outputs.drone_position_m, halves.outputs.drone_position_m);
  EXPECT_EQ(whole.outputs.range_down_m, halves.outputs.range_down_m);
  EXPECT_EQ(whole.outputs.imu_angular_velocity_rad_per_s, halves.outputs.imu_angular_velocity_rad_per_s);
}

TEST(WorldAlone, CommandedToFlyWithoutRotorsItStaysOnTheGround) {
  FlightRig rig(shipped_scene("gate_easy"));
  rig.inputs.setpoint_mode = FlightMode::take_off;
  for (std::int64_t t = 0; t < 5'000'000'000; t += 100'000'000) rig.world.step(t, 100'000'000);
  EXPECT_EQ(rig.outputs.drone_phase, FlightPhase::climbing);
  EXPECT_NEAR(rig.outputs.drone_position_m[2], 0.0145, 1e-5);
  for (const double command : rig.outputs.rotor_command) {
    EXPECT_GT(command, 0.5);
    EXPECT_LE(command, 1.0);
  }
}

}  // namespace
}  // namespace mebots::world
