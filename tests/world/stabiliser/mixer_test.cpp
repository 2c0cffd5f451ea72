// SPDX-License-Identifier: Apache-2.0
#include "stabiliser/stabiliser.hpp"

#include "support/flight_rig.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <complex>

namespace mebots::world {
namespace {

const scene::Drone& mixed_drone() {
  static const scene::Drone d = test::shipped_scene("empty").drone;
  return d;
}

Wrench wrench_of(const RotorValues& thrust_n) {
  RotorValues torque_n_m{};
  for (std::size_t i = 0; i < kRotors; ++i) torque_n_m[i] = mixed_drone().torque_per_thrust_m * thrust_n[i];
  return rotor_wrench(mixed_drone(), thrust_n, torque_n_m);
}

TEST(Mixer, InvertsTheRotorsWrench) {
  const Eigen::Vector3d torque_n_m{1e-3, -5e-4, 1e-4};
  const Wrench w = wrench_of(mix(mixed_drone(), 0.15, 0.4, torque_n_m));
  EXPECT_NEAR(w.force_n.z(), 0.4, 1e-15);
  EXPECT_TRUE(w.torque_n_m.isApprox(torque_n_m, 1e-12)) << w.torque_n_m.transpose();
}

TEST(Mixer, EveryRotorStaysWithinItsLimits) {
  for (const double collective_n : {-1.0, 0.0, 0.1, 0.5, 3.0}) {
    for (const double roll : {-1.0, -1e-3, 0.0, 2e-3}) {
      for (const double yaw : {-1e-1, 0.0, 1e-4}) {
        const auto thrust = mix(mixed_drone(), 0.15, collective_n, {roll, 0.5 * roll, yaw});
        EXPECT_GE(*std::min_element(thrust.begin(), thrust.end()), 0.0);
        EXPECT_LE(*std::max_element(thrust.begin(), thrust.end()), 0.15);
      }
    }
  }
}

TEST(Mixer, YawGivesWayToRollAndPitch) {
  const Eigen::Vector3d torque_n_m{4e-3, 0.0, 1e-2};
  const Wrench w = wrench_of(mix(mixed_drone(), 0.15, 0.3, torque_n_m));
  EXPECT_NEAR(w.torque_n_m.x(), 4e-3, 1e-15);
  EXPECT_NEAR(w.force_n.z(), 0.3, 1e-15);
  EXPECT_LT(w.torque_n_m.z(), 1e-2);
  EXPECT_GT(w.torque_n_m.z(), 0.0);
}

TEST(Mixer, HeightGivesWayToRollAndPitch) {
  const Wrench w = wrench_of(mix(mixed_drone(), 0.15, 0.6, {4e-3, 0.0, 0.0}));
  EXPECT_NEAR(w.torque_n_m.x(), 4e-3, 1e-15);
  EXPECT_LT(w.force_n.z(), 0.6);
}

TEST(ThrustCurve, CommandAndThrustInvertEachOther) {
  const ThrustCurve curve(mixed_drone().thrust_curve);
  for (double command = 0.0; command <= 1.0; command += 0.01) {
    EXPECT_NEAR(curve.command_for(curve.thrust_for(command)), command, 1e-12);
  }
  EXPECT_DOUBLE_EQ(curve.command_for(curve.max_thrust_n()), 1.0);
  EXPECT_EQ(curve.command_for(0.0), 0.0);
}

TEST(ThrustCurve, GivesTheBenchRows) {
  // The whole drone weighs 41.7 g and hovers at 75 % duty.
  const auto drone = test::shipped_drone("crazyflie_bench");
  EXPECT_NEAR(ThrustCurve(drone.thrust_curve).thrust_for(0.75), 0.0417 * 9.80665 / 4.0, 1e-6);  // rounded in the file
}

TEST(Gains, PutAllThreePolesWhereTheyShallBe) {
  // The closed loop has the characteristic polynomial T s^3 + (1 + k_a) s^2 + k_r s + k_r k_angle, where T is the lag
  // and the k are the gains. It must have a triple root at s = -p.
  const double p = 12.0;
  const double lag_s = 0.1;
  const auto k = Gains::rotation(p, lag_s);
  const auto value = [&](double s) {
    return lag_s * s * s * s + (1.0 + k.acceleration) * s * s + k.rate_per_s * s + k.rate_per_s * k.angle_per_s;
  };
  for (const double s : {-20.0, -p, -5.0, 0.0, 3.0}) {
    const double d = s + p;
    EXPECT_NEAR(value(s), lag_s * d * d * d, 1e-9);
  }
}

TEST(Gains, FastRotorsNeedNoAccelerationFeedback) {
  EXPECT_EQ(Gains::for_lag(0.0).tilt.acceleration, 0.0);
  EXPECT_GT(Gains::for_lag(0.0).tilt.rate_per_s, 0.0);
}

}  // namespace
}  // namespace mebots::world
