// SPDX-License-Identifier: Apache-2.0
#include "sensors/contact_sensor.hpp"

#include "support/fleet.hpp"
#include "support/flight_rig.hpp"
#include "support/same_state.hpp"

#include <gtest/gtest.h>

namespace mebots::world {
namespace {

using test::FlightRig;

constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr double kGravity = 9.80665;

test::RigParameters with_contact(double period_s = 0.001) {
  test::RigParameters parameters = FlightRig::small_camera();
  parameters.contact_enabled = true;
  parameters.contact_period_s = period_s;
  return parameters;
}

TEST(ContactSensor, MeasuresTheMeanForceOfAPeriod) {
  ContactSensor sensor(0.003, 0.0, 1);
  sensor.update(0, false, Eigen::Vector3d::Zero(), 0.001);
  sensor.update(kMillisecond_ns, true, {0.0, 0.0, 3.0}, 0.001);
  sensor.update(2 * kMillisecond_ns, true, {0.3, 0.0, 6.0}, 0.001);
  EXPECT_FALSE(sensor.touching());
  sensor.update(3 * kMillisecond_ns, false, Eigen::Vector3d::Zero(), 0.001);
  EXPECT_TRUE(sensor.touching());
  EXPECT_LT((sensor.force_B_n() - Eigen::Vector3d(0.1, 0.0, 3.0)).norm(), 1e-12);
  sensor.update(6 * kMillisecond_ns, false, Eigen::Vector3d::Zero(), 0.003);
  EXPECT_FALSE(sensor.touching());
  EXPECT_EQ(sensor.force_B_n(), Eigen::Vector3d(0.0, 0.0, 0.0));
}

TEST(ContactSensor, NoiseHasTheRequestedDeviation) {
  ContactSensor sensor(0.001, 0.02, 6);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  constexpr int kCount = 20'000;
  for (int i = 0; i < kCount; ++i) {
    sensor.update(i * kMillisecond_ns, true, {0.0, 0.0, 1.0}, 0.001);
    const Eigen::Vector3d error = sensor.force_B_n() - Eigen::Vector3d::UnitZ();
    sum += error;
    squares += error.cwiseAbs2();
  }
  for (int axis = 0; axis < 3; ++axis) {  // four standard errors
    EXPECT_NEAR(sum[axis] / kCount, 0.0, 4.0 * 0.02 / std::sqrt(kCount));
    EXPECT_NEAR(std::sqrt(squares[axis] / kCount), 0.02, 4.0 * 0.02 / std::sqrt(2.0 * kCount));
  }
}

TEST(ContactSensor, ADroneOnTheGroundFeelsItsWeight) {
  FlightRig rig(test::shipped_scene("empty"), with_contact(0.1));
  rig.run(2.0);
  EXPECT_TRUE(rig.outputs.contact_touching);
  EXPECT_NEAR(rig.outputs.contact_force_n[0], 0.0, 1e-6);
  EXPECT_NEAR(rig.outputs.contact_force_n[1], 0.0, 1e-6);
  EXPECT_NEAR(rig.outputs.contact_force_n[2], rig.outputs.drone_mass_kg * kGravity, 1e-6);
}

TEST(ContactSensor, FeelsNothingInFlight) {
  FlightRig rig(test::shipped_scene("empty"), with_contact());
  rig.take_off_and_fly();
  EXPECT_FALSE(rig.outputs.contact_touching);
  EXPECT_EQ(rig.outputs.contact_force_n, (std::array<double, 3>{}));
}

TEST(ContactSensor, TheImpulseOfAnImpactIsTheChangeOfMomentum) {
  // The drone falls level from 0.3 m without thrust, and bounces. Without drag, only gravity and contact change the
  // momentum.
  scene::Scene scene = test::shipped_scene("empty");
  scene.drone.drag_n_s_per_m.setZero();
  auto parameters = with_contact(0.002);
  parameters.start_offset_m = {0.0, 0.0, 0.3};
  FlightRig rig(scene, parameters);
  double impulse_n_s = 0.0;
  double greatest_n = 0.0;
  rig.run(1.0, [&] {
    impulse_n_s += 0.002 * rig.outputs.contact_force_n[2];
    greatest_n = std::max(greatest_n, rig.outputs.contact_force_n[2]);
  });
  const double mass_kg = rig.outputs.drone_mass_kg;
  EXPECT_NEAR(impulse_n_s, mass_kg * (rig.outputs.drone_velocity_m_per_s[2] + kGravity * 1.0), 1e-4 * mass_kg);
  EXPECT_GT(greatest_n, 10.0 * mass_kg * kGravity) << "an impact has a force far above the weight";
}

TEST(ContactSensor, DronesThatTouchFeelOppositeForces) {
  const auto scene = test::shipped_scene("empty");
  // The second drone rests on the first drone.
  test::RigParameters parameters = with_contact(0.1);
  parameters.start_spacing_m = {};
  const double height_m = scene.drone.body_size_m.z();
  test::Fleet fleet(scene, parameters, {{0.0, 0.0, 0.0}, {0.0, 0.0, height_m}});
  for (int i = 0; i < 1000; ++i) fleet.step();
  const double weight_n = fleet.drones[1].outputs.drone_mass_kg * kGravity;
  EXPECT_NEAR(fleet.drones[1].outputs.contact_force_n[2], weight_n, 1e-3 * weight_n);
  // The ground carries both drones. The sum of all contact forces on the lower drone is its own weight.
  EXPECT_NEAR(fleet.drones[0].outputs.contact_force_n[2], weight_n, 1e-3 * weight_n);
}

TEST(ContactSensor, ARestoredRunContinuesWithTheSameBits) {
  auto parameters = with_contact(0.01);
  parameters.contact_noise_n = 0.01;
  FlightRig straight(test::shipped_scene("empty"), parameters);
  straight.run(0.034);
  FlightRig other(test::shipped_scene("empty"), parameters);
  other.continue_from(straight);
  straight.run(0.1);
  other.run(0.1);
  EXPECT_TRUE(mebots::test::same_state(straight.world, other.world));
  EXPECT_EQ(straight.outputs.contact_force_n, other.outputs.contact_force_n);
}

}  // namespace
}  // namespace mebots::world
