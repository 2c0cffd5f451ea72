// SPDX-License-Identifier: Apache-2.0
#include "stabiliser/stabiliser.hpp"

#include "support/flight_rig.hpp"
#include "support/one_body.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

/// Tests step responses of the closed loop of world, stabiliser and four lagging rotors. They exchange their values at
/// each communication point. The bounds are those of the design (fmu_world/docs/stabiliser.md), and are wide enough for
/// every tested lag and step.
namespace mebots::world {
namespace {

using test::FlightRig;

/// Rotor lag [s] and communication step [ns].
class StepResponse : public testing::TestWithParam<std::tuple<double, std::int64_t>> {
 protected:
  StepResponse() {
    rig_.rotors.lag_s = std::get<0>(GetParam());
    rig_.rotors.sag = 0.93;
    rig_.take_off_and_fly(1.0, h_ns());
  }
  std::int64_t h_ns() const { return std::get<1>(GetParam()); }

  /// The time at which a step response first reaches 90 %, the time from which it stays within 5 %, and the overshoot.
  struct Response {
    double rise_s = 0.0;
    double settle_s = 0.0;
    double overshoot = 0.0;
    double final_error = 0.0;
  };
  template <typename Value>
  Response respond(double seconds, double from, double to, Value value) {
    Response response;
    const double start_s = rig_.time_s();
    bool risen = false;
    rig_.run(
        seconds,
        [&] {
          const double share = (value() - from) / (to - from);
          const double t_s = rig_.time_s() - start_s;
          if (!risen && share > 0.9) {
            risen = true;
            response.rise_s = t_s;
          }
          if (std::abs(share - 1.0) > 0.05) response.settle_s = t_s;
          response.overshoot = std::max(response.overshoot, share - 1.0);
          response.final_error = std::abs(share - 1.0);
        },
        h_ns());
    if (!risen) response.rise_s = seconds;
    return response;
  }

  FlightRig rig_;
};

TEST_P(StepResponse, ForwardVelocityReachesOneKilometrePerHourInTwoSecondsWithoutOvershoot) {
  rig_.inputs.setpoint_velocity_x_m_per_s = 1.0 / 3.6;
  const auto r = respond(6.0, 0.0, 1.0 / 3.6, [&] { return rig_.outputs.drone_forward_velocity_m_per_s; });
  EXPECT_LT(r.settle_s, 2.0);
  EXPECT_LT(r.overshoot, 0.03);
  EXPECT_LT(r.final_error, 0.005);
  EXPECT_NEAR(rig_.altitude_m(), 1.0, 0.005);
}

TEST_P(StepResponse, SidewaysVelocityFollowsAsWell) {
  rig_.inputs.setpoint_velocity_y_m_per_s = -0.4;
  const auto r = respond(6.0, 0.0, -0.4, [&] { return rig_.outputs.drone_velocity_m_per_s[1]; });
  EXPECT_LT(r.settle_s, 2.0);
  EXPECT_LT(r.overshoot, 0.03);
}

TEST_P(StepResponse, YawRateFollowsInHalfASecond) {
  rig_.inputs.setpoint_yaw_rate_rad_per_s = 0.5;
  const auto r = respond(3.0, 0.0, 0.5, [&] { return rig_.outputs.drone_angular_velocity_rad_per_s[2]; });
  EXPECT_LT(r.rise_s, 0.5);
  EXPECT_LT(r.overshoot, 0.15);
  EXPECT_LT(r.final_error, 0.005);
}

TEST_P(StepResponse, AltitudeRises30CentimetresInTwoSeconds) {
  rig_.inputs.setpoint_altitude_m = 1.3;
  const auto r = respond(6.0, 1.0, 1.3, [&] { return rig_.altitude_m(); });
  EXPECT_LT(r.settle_s, 2.5);
  EXPECT_LT(r.overshoot, 0.05);
  EXPECT_LT(r.final_error, 0.01);
}

TEST_P(StepResponse, WindIsHeldAgainst) {
  rig_.inputs.wind_velocity_m_per_s = {0.0, 2.0, 0.0};
  double fastest = 0.0;
  rig_.run(
      15.0, [&] { fastest = std::max(fastest, rig_.outputs.drone_speed_m_per_s); }, h_ns());
  EXPECT_LT(fastest, 0.5);
  EXPECT_LT(rig_.outputs.drone_speed_m_per_s, 0.01);
  EXPECT_NEAR(rig_.altitude_m(), 1.0, 0.01);
  // The drone leans into the wind. The tangent of the angle is the ratio of drag to weight.
  const double lean = std::atan(0.0147 * 2.0 / (0.04 * 9.80665));
  EXPECT_NEAR(rig_.outputs.drone_roll_rad, lean, 0.002);
}

TEST_P(StepResponse, ABusThatSagsMoreAndMoreIsMadeUpFor) {
  // The thrust decreases by 0.2 % per second, about twenty times as fast as by the discharge of a cell. With such a
  // ramp, the altitude has the steady error g rate / sag / (k_i k_altitude) = 0.0021 g / 2.4. Here `rate` is the 0.2 %
  // per second, `sag` is about 0.93, and k_i and k_altitude are the gains of the integrator and of the altitude.
  const double steady_m = 0.002 / 0.93 * kGravity_m_per_s2 / 2.4;
  double lowest_m = 1.0;
  for (int i = 0; i < 1000; ++i) {
    rig_.rotors.sag -= 2e-5;
    rig_.run(
        0.01, [&] { lowest_m = std::min(lowest_m, rig_.altitude_m()); }, h_ns());
  }
  EXPECT_GT(lowest_m, 1.0 - 1.5 * steady_m);
  EXPECT_LT(lowest_m, 1.0 - 0.7 * steady_m);
}

TEST_P(StepResponse, AttitudeStaysStillInHover) {
  double tilt_rad = 0.0;
  rig_.run(
      3.0,
      [&] { tilt_rad = std::max(tilt_rad, std::hypot(rig_.outputs.drone_roll_rad, rig_.outputs.drone_pitch_rad)); },
      h_ns());
  EXPECT_LT(tilt_rad, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(LagsAndSteps, StepResponse,
                         testing::Combine(testing::Values(0.03, 0.06, 0.1, 0.15),
                                          testing::Values(std::int64_t{1'000'000}, std::int64_t{2'000'000},
                                                          std::int64_t{5'000'000})));

TEST(Stabiliser, TurnsWhileItFliesWithoutSlidingOutwards) {
  FlightRig rig;
  rig.take_off_and_fly();
  rig.inputs.setpoint_velocity_x_m_per_s = 0.5;
  rig.inputs.setpoint_yaw_rate_rad_per_s = 0.3;
  rig.run(5.0);
  double slip = 0.0;
  rig.run(10.0, [&] {
    const auto& out = rig.outputs;
    const double left = -std::sin(out.drone_yaw_rad) * out.drone_velocity_m_per_s[0] +
                        std::cos(out.drone_yaw_rad) * out.drone_velocity_m_per_s[1];
    slip = std::max(slip, std::abs(left));
  });
  // The direction in which the drone leans lags the rotating heading by about 0.25 s x 0.3 rad/s. Therefore the drone
  // slips a little sideways.
  EXPECT_LT(slip, 0.05);
  EXPECT_NEAR(rig.outputs.drone_forward_velocity_m_per_s, 0.5, 0.02);
}

TEST(Stabiliser, HoldsItsPlaceAndHeadingWhileClimbing) {
  FlightRig rig;
  rig.inputs.setpoint_mode = FlightMode::take_off;
  rig.inputs.setpoint_velocity_x_m_per_s = 1.0;  // not for take-off
  rig.inputs.setpoint_yaw_rate_rad_per_s = 1.0;
  rig.run(8.0);
  EXPECT_NEAR(rig.outputs.drone_position_m[0], 0.0, 0.01);
  EXPECT_NEAR(rig.outputs.drone_yaw_rad, 0.0, 0.01);
}

TEST(Stabiliser, ComesBackFromATiltOf45Degrees) {
  // The drone starts at 5 m with the thrust of hovering. It may sink by at most a metre.
  const auto scene = test::shipped_scene("empty");
  Stabiliser stabiliser(scene.drone);
  test::OneBody bodies(scene);
  const double mass_kg = 0.04;
  const auto inertia = inertia_for(scene.drone, mass_kg);
  stabiliser.set_mass(mass_kg, inertia);
  bodies.set_mass(mass_kg, inertia);
  test::Rotors rotors(scene.drone);
  rotors.thrust_n.fill(0.25 * mass_kg * kGravity_m_per_s2);
  RigidState state;
  state.p_WB_m = {0.0, 0.0, 5.0};
  state.q_WB = Eigen::AngleAxisd(0.785, Eigen::Vector3d(1.0, 1.0, 0.0).normalized());
  StabiliserGoal goal;
  goal.motors_on = true;
  goal.altitude_m = 5.0;
  for (int i = 0; i < 12000; ++i) {
    const auto& command = stabiliser.update(goal, state, 1e-3);
    rotors.step(command, 1e-3);
    RotorValues torque{};
    for (std::size_t k = 0; k < 4; ++k) torque[k] = rotors.torque_per_thrust_m * rotors.thrust_n[k];
    const Wrench wrench = rotor_wrench(scene.drone, rotors.thrust_n, torque);
    bodies.step(state, state.q_WB * wrench.force_n, wrench.torque_n_m, 1e-3);
    ASSERT_GT(state.p_WB_m.z(), 4.0);
  }
  EXPECT_GT(state.rotation()(2, 2), std::cos(0.01));
  EXPECT_LT(state.v_WB_m_per_s.norm(), 0.02);
}

/// Returns the greatest of the four rotor commands at each of the first 1200 milliseconds after the start. The goal is
/// 1 m above `height_m`, but the drone is held at rest at `height_m`.
std::vector<double> commands_of_a_start(const scene::Drone& drone, double height_m) {
  Stabiliser stabiliser(drone);
  stabiliser.set_mass(0.04, drone.inertia_kg_m2);
  RigidState state;
  state.p_WB_m.z() = height_m;
  StabiliserGoal goal;
  goal.motors_on = true;
  goal.altitude_m = height_m + 1.0;
  std::vector<double> greatest;
  for (int i = 0; i < 1200; ++i) {
    const auto& command = stabiliser.update(goal, state, 1e-3);
    greatest.push_back(*std::max_element(command.begin(), command.end()));
  }
  return greatest;
}

TEST(Stabiliser, LimitsTheCommandsOfAStartOnTheGroundAsTheDroneFileSays) {
  const auto drone = test::shipped_drone("crazyflie");
  const auto commands = commands_of_a_start(drone, 0.5 * drone.body_size_m.z());
  EXPECT_NEAR(commands[0], drone.start_command, 1e-9);
  EXPECT_NEAR(commands[500], drone.start_command + 0.5 * (1.0 - drone.start_command), 1e-9);
  EXPECT_GT(commands[1100], 0.999) << "without a limit the integrator asks for all that there is";
  EXPECT_GT(commands_of_a_start(drone, 3.0)[0], 0.9) << "in the air";
  EXPECT_GT(commands_of_a_start(test::shipped_drone("crazyflie_bench"), 0.0)[0], 0.7);
}

TEST(Stabiliser, CommandsNothingWithTheMotorsOff) {
  const auto scene = test::shipped_scene("empty");
  Stabiliser stabiliser(scene.drone);
  stabiliser.set_mass(0.04, scene.drone.inertia_kg_m2);
  RigidState state;
  StabiliserGoal on;
  on.motors_on = true;
  on.altitude_m = 1.0;
  EXPECT_GT(stabiliser.update(on, state, 1e-3)[0], 0.5);
  EXPECT_EQ(stabiliser.update({}, state, 1e-3), RotorValues{});
}

}  // namespace
}  // namespace mebots::world
