// SPDX-License-Identifier: Apache-2.0
#include "crazyflie/kalman.hpp"
#include "crazyflie/low_pass.hpp"
#include "crazyflie/pid.hpp"
#include "crazyflie/power_distribution.hpp"
#include "dynamics/rigid_world.hpp"
#include "mebots/error.hpp"
#include "support/flight_rig.hpp"
#include "support/same_state.hpp"

#include <gmock/gmock.h>
#include <cmath>
#include <numbers>

namespace mebots::world {
namespace {

using crazyflie::Kalman;
using crazyflie::LowPass;
using crazyflie::Pid;
using Eigen::Vector3d;
using test::FlightRig;
using test::shipped_scene;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(CrazyfliePid, AddsUpItsThreeParts) {
  Pid pid({.kp = 2.0, .ki = 3.0, .kd = 0.5});
  pid.reset(1.0);
  // The error is 4, its integral is 4 x 0.1, and the rate is 10.
  EXPECT_NEAR(pid.update(6.0, 2.0, 0.1), 2.0 * 4.0 + 3.0 * 0.4 - 0.5 * 10.0, 1e-12);
  EXPECT_NEAR(pid.update(6.0, 2.0, 0.1), 2.0 * 4.0 + 3.0 * 0.8, 1e-12);
}

TEST(CrazyfliePid, ItsIntegralStopsAtTheLimitAndComesBackAtOnce) {
  Pid pid({.ki = 1.0, .integral_limit = 0.5});
  pid.reset(0.0);
  for (int i = 0; i < 1000; ++i) pid.update(1.0, 0.0, 0.01);
  EXPECT_DOUBLE_EQ(pid.update(1.0, 0.0, 0.01), 0.5);
  EXPECT_NEAR(pid.update(-1.0, 0.0, 0.01), 0.49, 1e-12);
}

TEST(CrazyfliePid, AnAngleGoesTheShortWay) {
  Pid pid({.kp = 1.0, .kd = 0.1, .wraps = true});
  pid.reset(179.0);
  EXPECT_NEAR(pid.update(-170.0, -179.0, 0.1), 9.0 - 0.1 * 20.0, 1e-9);
}

TEST(CrazyflieMotors, TurnTheDroneInTheRequestedDirection) {
  // Positive roll (to the right) requires more thrust of the left rotors, 3 and 4. Positive pitch (nose down) requires
  // more thrust of the rear rotors, 2 and 3.
  const auto torque_of = [](const crazyflie::Demand& demand) {
    const auto drone = shipped_scene("empty").drone;
    RotorValues thrust = crazyflie::distributed(demand);
    RotorValues torque{};
    for (std::size_t i = 0; i < kRotors; ++i) torque[i] = drone.torque_per_thrust_m * thrust[i];
    return rotor_wrench(drone, thrust, torque).torque_n_m;
  };
  constexpr double kHover = 36000.0;
  const Vector3d roll = torque_of({.thrust = kHover, .roll = 4000.0});
  EXPECT_GT(roll.x(), 1e-4);
  EXPECT_NEAR(roll.tail<2>().norm(), 0.0, 1e-12);
  const Vector3d pitch = torque_of({.thrust = kHover, .pitch = 4000.0});
  EXPECT_GT(pitch.y(), 1e-4);
  EXPECT_NEAR(pitch.x() + pitch.z(), 0.0, 1e-12);
  const Vector3d yaw = torque_of({.thrust = kHover, .yaw = 4000.0});
  EXPECT_GT(yaw.z(), 1e-4);
  EXPECT_NEAR(yaw.head<2>().norm(), 0.0, 1e-12);
}

TEST(CrazyflieMotors, AMotorBeyondFullLowersAllFour) {
  EXPECT_THAT(crazyflie::capped({1.25, 0.75, 0.5, 0.1}), ElementsAre(1.0, 0.5, 0.25, 0.0));
  EXPECT_THAT(crazyflie::capped({0.5, -0.1, 0.5, 0.5}), ElementsAre(0.5, 0.0, 0.5, 0.5));
}

/// Returns the thrust of a rotor at a motor voltage by the firmware's cubic.
double thrust_n(const crazyflie::ThrustOverVoltage& rotor, double v) {
  return rotor.constant_n + rotor.linear_n_per_v * v + rotor.square_n_per_v2 * v * v + rotor.cubic_n_per_v3 * v * v * v;
}

TEST(CrazyflieMotors, CompensationGivesTheVoltageThatThePublishedCubicHasForAThrust) {
  for (const auto propellers : {Propellers::legacy, Propellers::plus, Propellers::thrust_upgrade}) {
    const auto& rotor = crazyflie::thrust_over_voltage(propellers);
    for (const double share : {0.11, 0.3, 0.55, 0.82, 1.0}) {
      const double v = 3.7 * crazyflie::compensated(share, 3.7, rotor);
      EXPECT_NEAR(thrust_n(rotor, v), rotor.most_n * share, 1e-12) << share;
    }
    EXPECT_EQ(crazyflie::compensated(0.1, 3.7, rotor), 0.0);  // 0.012 and 0.018 N
    EXPECT_NEAR(crazyflie::compensated(0.5, 3.0, rotor), crazyflie::compensated(0.5, 4.2, rotor) * 4.2 / 3.0, 1e-12);
  }
}

// Bitcraze's table for the 2.1+ contains 0.1067 N at 2.93 V (rotor file crazyflie_21plus, steady_speed and
// thrust_coefficient).
TEST(CrazyflieMotors, PropellersOfThe21PlusNeedMoreVoltageForAThrust) {
  const auto voltage_for = [](Propellers propellers) {
    return 3.7 * crazyflie::compensated(0.1067 / 0.12, 3.7, crazyflie::thrust_over_voltage(propellers));
  };
  EXPECT_NEAR(voltage_for(Propellers::plus), 2.93, 0.01);
  EXPECT_NEAR(voltage_for(Propellers::legacy), 2.84, 0.01);
}

TEST(CrazyflieLowPass, LetsThroughWhatIsSlowAndHalvesThePowerAtItsCutoff) {
  LowPass filter(80.0, 1000.0);
  const Vector3d constant{1.0, -2.0, 3.0};
  EXPECT_LT((filter(constant) - constant).norm(), 1e-12);  // starts in the steady state
  LowPass other(80.0, 1000.0);
  double most = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const double x = std::sin(2.0 * std::numbers::pi * 80.0 * i / 1000.0);
    const Vector3d y = other(Vector3d(x, 0.0, 0.0));
    if (i > 1000) most = std::max(most, std::abs(y.x()));
  }
  EXPECT_NEAR(most, std::numbers::sqrt2 / 2.0, 0.01);  // with 12.5 samples per period, the peak is missed by at most 1
                                                       // %
}

/// Updates the filter with readings without noise: those of a drone in level flight with the velocity v (body axes) at
/// the height h.
void fly_level(Kalman& filter, const scene::FlowData& flow, const Vector3d& v, double h_m, double seconds) {
  const Vector3d force{0.0, 0.0, kGravity_m_per_s2};
  const int count = static_cast<int>(std::lround(100.0 * seconds));
  for (int k = 0; k < count; ++k) {
    filter.predict(force, Vector3d::Zero(), true, 0.01);
    for (int i = 0; i < 10; ++i) filter.add_process_noise(0.001);
    const double scale = 0.01 * flow.pixels_per_rad / h_m;
    filter.measure_flow({scale * v.x(), scale * v.y()}, Vector3d::Zero(), 0.01);
    if (k % 4 == 0) filter.measure_distance(h_m);
    filter.finish();
  }
}

TEST(CrazyflieKalman, FindsVelocityAndHeightFromFlowAndDistance) {
  const auto flow = *shipped_scene("empty").drone.flow;
  RigidState start;
  start.p_WB_m = {2.0, -1.0, 0.8};
  Kalman filter(flow, start);
  fly_level(filter, flow, {0.5, -0.2, 0.0}, 1.0, 30.0);
  EXPECT_LT((filter.velocity_W_m_per_s() - Vector3d(0.5, -0.2, 0.0)).norm(), 0.01);
  EXPECT_NEAR(filter.position_m().z(), 1.0, 1e-3);
  // No sensor measures the position. The filter integrates the estimated velocity, which is wrong at first.
  EXPECT_NEAR(filter.position_m().x(), 2.0 + 0.5 * 30.0, 1.0);
  EXPECT_LT(filter.deviation(3), 0.2);
  EXPECT_GT(filter.deviation(0), 1.0);
}

TEST(CrazyflieKalman, RightsAnAttitudeThatItHadWrong) {
  const auto flow = *shipped_scene("empty").drone.flow;
  RigidState start;
  start.p_WB_m.z() = 1.0;
  start.q_WB = Eigen::AngleAxisd(0.05, Vector3d::UnitX());
  Kalman filter(flow, start);
  fly_level(filter, flow, Vector3d::Zero(), 1.0, 10.0);
  const Vector3d up_B = filter.attitude().conjugate() * Vector3d::UnitZ();
  EXPECT_LT(up_B.head<2>().norm(), 0.005);  // a tenth of its previous value
}

TEST(CrazyflieKalman, FollowsTheGyroscopeThroughAWholeTurn) {
  const auto flow = *shipped_scene("empty").drone.flow;
  Kalman filter(flow, RigidState{});
  const double rate = 2.0 * std::numbers::pi / 3.0;
  for (int k = 0; k < 300; ++k) {
    filter.predict({0.0, 0.0, kGravity_m_per_s2}, {0.0, 0.0, rate}, true, 0.01);
    filter.finish();
  }
  EXPECT_NEAR(filter.attitude().angularDistance(Eigen::Quaterniond::Identity()), 0.0, 1e-6);
}

/// Returns the parameters of a real Crazyflie: the firmware's controller uses the estimate. The IMU is noisy.
test::RigParameters own() {
  test::RigParameters p = FlightRig::small_camera();
  p.stabiliser_controller = FlightController::crazyflie;
  p.stabiliser_state = StateSource::estimate;
  p.range_model = RangeModel::cone;
  p.imu_acceleration_noise_m_per_s2 = 0.03;
  p.imu_rate_noise_rad_per_s = 0.006;
  return p;
}

test::RigParameters knowing() {
  test::RigParameters p = FlightRig::small_camera();
  p.stabiliser_controller = FlightController::crazyflie;
  return p;
}

void expect_a_landing(FlightRig& rig) {
  rig.inputs.setpoint_mode = FlightMode::land;
  rig.run(10.0);
  EXPECT_TRUE(rig.outputs.drone_landed);
  EXPECT_FALSE(rig.outputs.drone_crashed);
  for (const double command : rig.outputs.rotor_command) EXPECT_EQ(command, 0.0);
}

TEST(CrazyflieEstimate, AFlightAcrossTimeZeroIsThatOfAnyOtherTime) {
  // 100 ms are a whole number of periods of every sensor and of the controller. Without noise, time affects a flight
  // only through these periods. Therefore a flight that starts 100 ms later must be the same.
  constexpr std::int64_t kMillisecond = 1'000'000;
  test::RigParameters p = own();
  p.range_model = RangeModel::ray;
  p.imu_acceleration_noise_m_per_s2 = 0.0;
  p.imu_rate_noise_rad_per_s = 0.0;
  auto scene = shipped_scene("empty");
  scene.drone.flow->noise_pixels = 0.0;
  for (const std::int64_t start_ms : {-100, -24, -9, -1}) {
    FlightRig across(scene, p, start_ms * kMillisecond);
    FlightRig after(scene, p, (start_ms + 100) * kMillisecond);
    for (auto* rig : {&across, &after}) {
      rig->inputs.setpoint_mode = FlightMode::take_off;
      rig->run(2.0, kMillisecond);
    }
    EXPECT_GT(after.altitude_m(), 0.1);
    EXPECT_EQ(across.outputs.rotor_command, after.outputs.rotor_command) << start_ms;
    EXPECT_EQ(across.outputs.drone_position_m, after.outputs.drone_position_m) << start_ms;
    EXPECT_EQ(across.outputs.estimate_position_m, after.outputs.estimate_position_m) << start_ms;
    EXPECT_EQ(across.outputs.imu_acceleration_m_per_s2, after.outputs.imu_acceleration_m_per_s2) << start_ms;
    EXPECT_EQ(across.outputs.range_down_m, after.outputs.range_down_m) << start_ms;
  }
}

TEST(CrazyflieController, TakesOffFliesThroughTheGateAndLands) {
  test::RigParameters p = knowing();
  p.start_offset_m = {0.0, 0.25, 0.0};  // the centre of the gate
  FlightRig rig(shipped_scene("gate_easy"), p);
  rig.take_off_and_fly();
  EXPECT_NEAR(rig.altitude_m(), 1.0, 0.1);  // its integrals take long to settle
  rig.inputs.setpoint_velocity_x_m_per_s = 0.3;
  rig.run(20.0);
  EXPECT_TRUE(rig.outputs.gate_passed);
  expect_a_landing(rig);
}

TEST(CrazyflieController, TakesOffFliesAndLandsOnItsOwnEstimate) {
  FlightRig rig(shipped_scene("empty"), own());
  rig.take_off_and_fly();
  EXPECT_NEAR(rig.altitude_m(), 1.0, 0.1);
  rig.inputs.setpoint_velocity_x_m_per_s = 0.3;
  rig.run(10.0);
  EXPECT_EQ(rig.outputs.drone_phase, FlightPhase::flying);
  EXPECT_NEAR(rig.outputs.drone_position_m[0], 3.0, 0.5);
  expect_a_landing(rig);
}

/// The firmware's filter does not check whether a distance is plausible.
TEST(CrazyflieEstimate, TakesTheLowerBeamOfAGateForTheGround) {
  test::RigParameters p = own();
  p.start_offset_m = {0.0, 0.25, 0.0};
  FlightRig rig(shipped_scene("gate_easy"), p);
  rig.take_off_and_fly();
  rig.inputs.setpoint_velocity_x_m_per_s = 0.3;
  double most_m = 0.0;
  rig.run(20.0,
          [&] { most_m = std::max(most_m, rig.outputs.drone_position_m[2] - rig.outputs.estimate_position_m[2]); });
  EXPECT_TRUE(rig.outputs.gate_reached);
  EXPECT_GT(most_m, 0.3);
}

TEST(CrazyflieController, ReachesTheRequestedVelocityAndYawRate) {
  FlightRig rig(shipped_scene("empty"), knowing());
  rig.take_off_and_fly();
  rig.inputs.setpoint_velocity_x_m_per_s = 0.5;
  rig.inputs.setpoint_velocity_y_m_per_s = 0.2;
  rig.run(6.0);
  EXPECT_NEAR(rig.outputs.drone_velocity_m_per_s[0], 0.5, 0.05);  // its integral takes a minute to compensate the drag
  EXPECT_NEAR(rig.outputs.drone_velocity_m_per_s[1], 0.2, 0.05);
  rig.inputs.setpoint_velocity_x_m_per_s = 0.0;
  rig.inputs.setpoint_velocity_y_m_per_s = 0.0;
  rig.inputs.setpoint_yaw_rate_rad_per_s = 0.5;
  rig.run(4.0);
  EXPECT_NEAR(rig.outputs.drone_angular_velocity_rad_per_s[2], 0.5, 0.02);
}

TEST(CrazyflieController, RunsEveryTwoMilliseconds) {
  FlightRig rig(shipped_scene("empty"), own());
  rig.take_off_and_fly();
  int changes = 0;
  auto last = rig.outputs.rotor_command;
  rig.run(
      0.1,
      [&] {
        changes += rig.outputs.rotor_command != last ? 1 : 0;
        last = rig.outputs.rotor_command;
      },
      500'000);
  EXPECT_EQ(changes, 50);
}

TEST(CrazyflieController, ASaggingBusDoesNotChangeTheAltitudeIfItIsMeasured) {
  FlightRig rig(shipped_scene("empty"), knowing());
  rig.inputs.bus_voltage_v = 3.9;
  rig.take_off_and_fly();
  EXPECT_NEAR(rig.altitude_m(), 1.0, 0.1);
  const double command = rig.outputs.rotor_command[0];
  rig.inputs.bus_voltage_v = 3.3;
  rig.step();
  EXPECT_NEAR(rig.outputs.rotor_command[0] / command, 3.9 / 3.3, 0.02);
}

TEST(CrazyflieEstimate, StaysNearTheTruthOverAMinuteOfHover) {
  FlightRig rig(shipped_scene("empty"), own());
  rig.take_off_and_fly();
  double worst_velocity = 0.0;
  double worst_altitude = 0.0;
  rig.run(60.0, [&] {
    const auto& out = rig.outputs;
    for (std::size_t i = 0; i < 2; ++i)
      worst_velocity =
          std::max(worst_velocity, std::abs(out.estimate_velocity_m_per_s[i] - out.drone_velocity_m_per_s[i]));
    worst_altitude = std::max(worst_altitude, std::abs(out.estimate_position_m[2] - out.drone_position_m[2]));
  });
  EXPECT_LT(worst_velocity, 0.15);
  EXPECT_LT(worst_altitude, 0.03);
  EXPECT_GT(worst_velocity, 1e-3);  // noise is there
  EXPECT_NEAR(rig.outputs.drone_position_m[0], rig.outputs.estimate_position_m[0], 0.5);
}

TEST(CrazyflieState, ARestoredRunContinuesWithTheSameBits) {
  FlightRig straight(shipped_scene("gate_easy"), own());
  straight.inputs.setpoint_mode = FlightMode::take_off;
  straight.run(3.001, std::int64_t{1'000'000});  // between two periods of all sensors and controllers
  FlightRig other(shipped_scene("gate_easy"), own());
  other.inputs = straight.inputs;
  other.outputs = straight.outputs;
  other.outputs.camera_frame = {};
  other.rotors = straight.rotors;
  other.time_ns = straight.time_ns;
  state::restore(other.world, state::save(straight.world));
  for (FlightRig* rig : {&straight, &other}) {
    rig->inputs.setpoint_mode = FlightMode::fly;
    rig->inputs.setpoint_velocity_x_m_per_s = 0.3;
    rig->run(4.0);
  }
  EXPECT_TRUE(mebots::test::same_state(straight.world, other.world));
  EXPECT_EQ(straight.outputs.drone_position_m, other.outputs.drone_position_m);
  EXPECT_EQ(straight.outputs.estimate_position_m, other.outputs.estimate_position_m);
  EXPECT_EQ(straight.outputs.flow_motion_x, other.outputs.flow_motion_x);
}

TEST(CrazyflieParameters, RefusesWhatCannotFly) {
  test::RigParameters slow = knowing();
  slow.physics_step_s = 0.004;
  EXPECT_THAT([&] { FlightRig(shipped_scene("empty"), slow); },
              ThrowsMessage<Error>(HasSubstr("physics.step = 0.004 s is too long for stabiliser.controller")));
  for (const auto controller : {FlightController::ideal, FlightController::crazyflie}) {
    test::RigParameters sparse = own();
    sparse.stabiliser_controller = controller;
    sparse.physics_step_s = 0.0015;
    EXPECT_THAT(
        [&] { FlightRig(shipped_scene("empty"), sparse); },
        ThrowsMessage<Error>(AllOf(HasSubstr("physics.step = 0.0015 s is too long for stabiliser.state = estimate"),
                                   HasSubstr("set physics.step to 0.001 or less"))));
    sparse.physics_step_s = 0.001;
    EXPECT_NO_THROW(FlightRig(shipped_scene("empty"), sparse));
  }
  test::RigParameters unknown = FlightRig::small_camera();
  unknown.stabiliser_controller = static_cast<FlightController>(7);
  EXPECT_THAT([&] { FlightRig(shipped_scene("empty"), unknown); },
              ThrowsMessage<Error>(HasSubstr("stabiliser.controller = 7 is not a controller")));
  test::RigParameters strange = knowing();
  strange.stabiliser_propellers = static_cast<Propellers>(7);
  EXPECT_THAT([&] { FlightRig(shipped_scene("empty"), strange); },
              ThrowsMessage<Error>(HasSubstr("stabiliser.propellers = 7 are no known propellers")));
  scene::Scene bare = shipped_scene("empty");
  bare.drone.flow.reset();
  EXPECT_THAT([&] { FlightRig(bare, own()); }, ThrowsMessage<Error>(HasSubstr("needs flow_sensor in the drone file")));
  bare.drone.range.reset();
  EXPECT_THAT([&] { FlightRig(bare, own()); },
              ThrowsMessage<Error>(HasSubstr("range.model = cone needs range_sensor")));
}

}  // namespace
}  // namespace mebots::world
