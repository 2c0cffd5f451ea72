// SPDX-License-Identifier: Apache-2.0
// Tests effects that parameters enable: spinning rotors, ground effect, gusts, the link, inertial sensors.
#include "mebots/error.hpp"
#include "support/flight_rig.hpp"
#include "support/same_state.hpp"
#include "wind/dryden.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <utility>

namespace mebots::world {
namespace {

using Eigen::Vector3d;
using test::FlightRig;
using test::shipped_scene;

TEST(SpinTorque, DoesNoWorkAndIsMinusRateCrossMomentum) {
  const RotorValues speed{2000, 1900, 2100, 1700};
  const Vector3d rate{0.7, -1.1, 2.0};
  const Vector3d torque = spin_torque(7e-8, speed, {}, rate);
  EXPECT_NEAR(torque.dot(rate), 0.0, 1e-20);
  // Rotors 1 and 3 turn counter-clockwise seen from above, which is along +z.
  const Vector3d momentum{0.0, 0.0, 7e-8 * (2000 - 1900 + 2100 - 1700)};
  EXPECT_TRUE(torque.isApprox(-rate.cross(momentum), 1e-12));
}

TEST(SpinTorque, ARotorThatSpeedsUpTurnsTheBodyTheOtherWay) {
  const Vector3d torque = spin_torque(7e-8, {}, {1000, 0, 0, 0}, Vector3d::Zero());
  EXPECT_TRUE(torque.isApprox(Vector3d(0, 0, -7e-5), 1e-12));
}

TEST(GroundEffect, HasCheesemanAndBennettsValues) {
  constexpr double kRadius_m = 0.02355;
  EXPECT_NEAR(ground_effect(kRadius_m, kRadius_m), 16.0 / 15.0, 1e-12);
  EXPECT_NEAR(ground_effect(2 * kRadius_m, kRadius_m), 64.0 / 63.0, 1e-12);
  EXPECT_NEAR(ground_effect(1.0, kRadius_m), 1.0, 4e-5);
  EXPECT_EQ(ground_effect(0.0, kRadius_m), ground_effect(0.5 * kRadius_m, kRadius_m));
}

TEST(GroundEffect, LiftsADroneOverTheGroundAndNotAboveIt) {
  for (const double altitude_m : {0.03, 1.0}) {
    test::RigParameters p = FlightRig::small_camera();
    p.rotors_ground_effect = 1.0;
    p.start_offset_m = {0.0, 0.0, altitude_m};
    FlightRig rig(shipped_scene("empty"), p);
    const double weight_n = rig.outputs.drone_mass_kg * kGravity_m_per_s2;
    rig.inputs.rotor_thrust_n.fill(0.25 * weight_n);
    rig.world.step(0, 1'000'000);
    const double height_m = 0.0145 + altitude_m + 0.0145;  // the height of the rotors: the top of the body
    const double expected = (ground_effect(height_m, p.rotors_radius_m) - 1.0) * kGravity_m_per_s2 * 1e-3;
    EXPECT_NEAR(rig.outputs.drone_velocity_m_per_s[2], expected, 1e-9) << altitude_m;
  }
}

TEST(Dryden, HasItsIntensityAndItsLength) {
  const double dt_s = 0.01;
  Dryden gusts({1.5, 2.0, 4.0, 7});
  constexpr int kCount = 400'000;
  std::vector<Vector3d> samples;
  for (std::int64_t k = 0; k < kCount; ++k) samples.push_back(gusts.at(k * 10'000'000));
  const auto correlation = [&](int axis, int lag) {
    double sum = 0.0;
    for (std::size_t i = static_cast<std::size_t>(lag); i < samples.size(); ++i) {
      sum += samples[i][axis] * samples[i - static_cast<std::size_t>(lag)][axis];
    }
    return sum / static_cast<double>(kCount - lag);
  };
  // tau = L / V = 0.5 s. 4000 s contain some thousands of independent gusts, so a variance is accurate to 2 or 3 %.
  const double tau_s = 0.5;
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(correlation(axis, 0), 2.25, 0.2) << axis;
  for (const int lag : {10, 25, 50, 100}) {
    const double t = lag * dt_s / tau_s;
    EXPECT_NEAR(correlation(0, lag) / 2.25, std::exp(-t), 0.07) << lag;
    // The expected value is the inverse transform of the lateral spectrum.
    EXPECT_NEAR(correlation(1, lag) / 2.25, (1.0 - 0.5 * t) * std::exp(-t), 0.07) << lag;
    EXPECT_NEAR(correlation(2, lag) / 2.25, (1.0 - 0.5 * t) * std::exp(-t), 0.07) << lag;
  }
}

TEST(Dryden, IsTheSameWhateverTheSteps) {
  const Dryden::Settings settings{1.0, 5.0, 1.0, 3};
  Dryden fine(settings);
  Dryden coarse(settings);
  for (std::int64_t ms = 0; ms < 2000; ++ms) fine.at(ms * 1'000'000);
  coarse.at(0);
  EXPECT_EQ(coarse.at(1'999'000'000), fine.at(1'999'000'000));
}

TEST(Dryden, BlowsBeforeTimeZeroAsAfter) {
  // Periods of 10 ms, one of which starts at 0. The gust is constant in a period, and changes between periods with tau
  // = 5 s.
  Dryden gusts({1.0, 5.0, 1.0, 3});
  Vector3d last = gusts.at(-10'000'000'000);
  double sum = 0.0;
  int changes = 0;
  for (std::int64_t ms = -9'999; ms < 1'000; ++ms) {
    const Vector3d now = gusts.at(ms * 1'000'000);
    changes += now != last ? 1 : 0;
    sum += std::abs(now.x() - last.x());
    last = now;
  }
  EXPECT_EQ(changes, 1'099);
  EXPECT_NEAR(sum / changes, std::sqrt(2.0 / M_PI) * std::sqrt(2.0 * 0.01 / 5.0), 0.005);
}

TEST(Dryden, RefusesWhatIsNoGust) {
  EXPECT_THROW(Dryden({-1.0, 5.0, 1.0, 3}), Error);
  EXPECT_THROW(Dryden({1.0, 0.0, 1.0, 3}), Error);
  EXPECT_THROW(Dryden({1.0, 5.0, NAN, 3}), Error);
}

TEST(Dryden, HasTheLeastLengthAndSpeedOfItsDescription) {
  Dryden({1.0, 0.001, 1.0, 3});
  Dryden({1.0, 1.0, 0.001, 3});
  EXPECT_THAT(
      [] {
        Dryden({1.0, 0.0009, 1.0, 3});
      },
      testing::ThrowsMessage<Error>(testing::HasSubstr("gust.length = 0.0009 must be a finite number >= 0.001")));
  EXPECT_THAT(
      [] {
        Dryden({1.0, 1.0, 0.0009, 3});
      },
      testing::ThrowsMessage<Error>(testing::HasSubstr("gust.speed = 0.0009 must be a finite number >= 0.001")));
}

TEST(Dryden, NamesSpeedAndLengthThatNoFilterCanHave) {
  const auto named = testing::ThrowsMessage<Error>(
      testing::AllOf(testing::HasSubstr("gust.speed = "), testing::HasSubstr("gust.length = ")));
  EXPECT_THAT([] { Dryden({1.0, 1e15, 0.01, 3}); }, named);
  EXPECT_THAT([] { Dryden({1.0, 0.001, 1e300, 3}); }, named);
  EXPECT_THAT([] { Dryden({1.0, 0.001, 1e10, 3}); }, named);
  // Near the limits of speed / length, the gusts stay small. If the intensity is 0, speed and length are not checked.
  for (const auto& [length_m, speed_m_per_s] : {std::pair{5e11, 1.0}, std::pair{0.001, 5e8}}) {
    Dryden gusts({1.0, length_m, speed_m_per_s, 3});
    gusts.at(0);
    EXPECT_LT(gusts.at(10'000'000'000).norm(), 10.0) << length_m;
  }
  EXPECT_EQ(Dryden({0.0, 1e15, 0.01, 3}).at(1'000'000'000), Vector3d::Zero());
}

TEST(Link, ASetpointArrivesAfterItsLatencyAndInOrder) {
  Link link(20'000'000);
  const Setpoint climb{FlightMode::take_off, 0, 0, 0, 1.0};
  const Setpoint go{FlightMode::fly, 0.3, 0, 0, 1.0};
  EXPECT_EQ(link.exchange(climb, 0).mode, FlightMode::off);
  EXPECT_EQ(link.exchange(go, 4'000'000).mode, FlightMode::off);
  EXPECT_EQ(link.exchange(go, 19'999'999).mode, FlightMode::off);
  EXPECT_EQ(link.exchange(go, 20'000'000).mode, FlightMode::take_off);
  EXPECT_EQ(link.exchange(go, 23'999'999).mode, FlightMode::take_off);
  EXPECT_EQ(link.exchange(go, 24'000'000), go);
}

TEST(Link, LatencyShiftsAFlightInTime) {
  // The latency delays the take-off by 0.1 s. The rest of the flight must have the same bits.
  test::RigParameters late = FlightRig::small_camera();
  late.setpoint_latency_s = 0.1;
  FlightRig delayed(shipped_scene("empty"), late);
  FlightRig direct(shipped_scene("empty"));
  direct.run(0.1);
  for (auto* rig : {&delayed, &direct}) rig->inputs.setpoint_mode = FlightMode::take_off;
  delayed.run(3.1);
  direct.run(3.0);
  EXPECT_EQ(delayed.outputs.drone_position_m, direct.outputs.drone_position_m);
  EXPECT_GT(delayed.altitude_m(), 0.5);
}

TEST(Link, ReportsTheDelayOfSetpointsAndWhenRotorsFollowThem) {
  test::RigParameters parameters = FlightRig::small_camera();
  parameters.setpoint_latency_s = 0.005;
  FlightRig rig(shipped_scene("empty"), parameters);
  rig.run(0.1);
  const auto still = rig.outputs.rotor_command;
  rig.inputs.setpoint_mode = FlightMode::take_off;
  const double sent_s = rig.time_s();
  while (rig.outputs.rotor_command == still && rig.time_s() < sent_s + 0.1) rig.step();
  const double took_s = rig.time_s() - sent_s;
  EXPECT_GE(rig.outputs.setpoint_link_time_s, 0.005);
  EXPECT_NEAR(rig.outputs.setpoint_link_time_s + rig.outputs.setpoint_control_time_s, took_s, 1e-9);
}

TEST(Imu, MeasuresTheWeightAtRestAndZeroInFreeFall) {
  FlightRig standing;
  standing.run(0.5);
  EXPECT_NEAR(standing.outputs.imu_acceleration_m_per_s2[2], kGravity_m_per_s2, 1e-3);
  test::RigParameters high = FlightRig::small_camera();
  high.start_offset_m = {0.0, 0.0, 5.0};
  FlightRig falling(shipped_scene("empty"), high);
  falling.run(0.02);
  EXPECT_NEAR(Eigen::Map<const Vector3d>(falling.outputs.imu_acceleration_m_per_s2.data()).norm(), 0.0, 0.1);  // drag
}

TEST(Imu, HasTheRequestedNoiseAndBias) {
  Imu imu({0.3, 0.0, 0.02, 0.0}, 5);
  Imu biased({0.0, 0.5, 0.0, 0.1}, 5);
  RigidState still;
  double acceleration = 0.0;
  double rate = 0.0;
  constexpr int kCount = 20'000;
  for (std::int64_t ms = 1; ms <= kCount; ++ms) {
    imu.update(ms * 1'000'000, still, still, 1e-3);
    biased.update(ms * 1'000'000, still, still, 1e-3);
    const Vector3d error = imu.acceleration_m_per_s2() - Vector3d(0, 0, kGravity_m_per_s2);
    acceleration += error.squaredNorm() / 3.0;
    rate += imu.rate_rad_per_s().squaredNorm() / 3.0;
  }
  // With 60,000 samples, a standard deviation is accurate to 0.3 %.
  EXPECT_NEAR(std::sqrt(acceleration / kCount), 0.3, 0.005);
  EXPECT_NEAR(std::sqrt(rate / kCount), 0.02, 4e-4);
  const Vector3d bias = biased.rate_rad_per_s();
  EXPECT_GT(bias.norm(), 0.0);
  biased.update(30'000'000'000, still, still, 1e-3);
  EXPECT_EQ(biased.rate_rad_per_s(), bias);
}

test::RigParameters everything() {
  test::RigParameters p = FlightRig::small_camera();
  p.rotors_inertia_kg_m2 = 7e-8;
  p.rotors_ground_effect = 1.0;
  p.gust_intensity_m_per_s = 0.4;
  p.setpoint_latency_s = 0.03;
  p.imu_acceleration_noise_m_per_s2 = 0.05;
  p.imu_rate_noise_rad_per_s = 0.01;
  p.camera_exposure_s = 0.01;
  p.camera_auto_exposure = true;
  p.camera_line_time_s = 6e-5;
  return p;
}

void fly(FlightRig& rig, int steps) {
  for (int i = 0; i < steps; ++i) {
    rig.inputs.setpoint_mode = rig.time_s() < 4.0 ? FlightMode::take_off : FlightMode::fly;
    rig.inputs.setpoint_velocity_x_m_per_s = 0.3;
    for (std::size_t k = 0; k < 4; ++k)
      rig.inputs.rotor_speed_rad_per_s[k] = std::sqrt(rig.rotors.thrust_n[k] / 2.2e-8);
    rig.inputs.camera_trigger = static_cast<std::int32_t>(rig.time_s() / 0.05);
    rig.step();
  }
}

TEST(Physics, ContinuesWithTheSameBitsAfterARestoreWithAllEffects) {
  FlightRig straight(shipped_scene("gate_easy"), everything());
  fly(straight, 1500);
  FlightRig other(shipped_scene("gate_easy"), everything());
  other.inputs = straight.inputs;
  other.rotors = straight.rotors;
  other.time_ns = straight.time_ns;
  other.outputs = straight.outputs;
  state::restore(other.world, state::save(straight.world));
  fly(straight, 1500);
  fly(other, 1500);
  EXPECT_TRUE(mebots::test::same_state(other.world, straight.world));
  EXPECT_EQ(other.outputs.imu_acceleration_m_per_s2, straight.outputs.imu_acceleration_m_per_s2);
  EXPECT_FALSE(straight.outputs.drone_crashed);
  EXPECT_NEAR(straight.altitude_m(), 1.0, 0.2);
}

}  // namespace
}  // namespace mebots::world
