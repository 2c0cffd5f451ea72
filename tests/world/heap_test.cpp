// SPDX-License-Identifier: Apache-2.0
#include "support/allocations.hpp"
#include "support/fleet.hpp"

#include <gtest/gtest.h>

namespace mebots::world {
namespace {

using mebots::test::allocations;

TEST(WorldHeap, StepsInFlightAndOnTheGroundAllocateNothing) {
  test::FlightRig rig(test::shipped_scene("gate_easy"));
  rig.run(0.1);  // contact with the ground fills the list of touches
  long before = allocations();
  rig.run(0.5);
  EXPECT_EQ(allocations(), before) << "on the ground";
  rig.take_off_and_fly();
  rig.inputs.setpoint_velocity_x_m_per_s = 0.3;
  rig.run(1.0);
  before = allocations();
  rig.run(2.0);
  EXPECT_EQ(allocations(), before) << "in flight";
}

TEST(WorldHeap, TheCrazyflieControllerAllocatesNothing) {
  auto parameters = test::FlightRig::small_camera();
  parameters.stabiliser_controller = FlightController::crazyflie;
  parameters.stabiliser_state = StateSource::estimate;
  parameters.range_model = RangeModel::cone;
  test::FlightRig rig(test::shipped_scene("gate_easy"), parameters);
  rig.take_off_and_fly();
  rig.inputs.setpoint_velocity_x_m_per_s = 0.3;
  rig.run(1.0);
  const long before = allocations();
  rig.run(1.0);
  EXPECT_EQ(allocations(), before);
}

TEST(WorldHeap, PicturesAllocateNothingAfterTheFirst) {
  test::FlightRig rig(test::shipped_scene("gate_easy"));
  rig.inputs.camera_trigger = 1;
  rig.step();
  const long before = allocations();
  for (int i = 2; i < 20; ++i) {
    rig.inputs.camera_trigger = i;
    rig.step();
  }
  EXPECT_EQ(allocations(), before);
}

TEST(WorldHeap, SensorsThatAreSwitchedOnAllocateNothing) {
  auto parameters = test::FlightRig::small_camera();
  parameters.multiranger_enabled = true;
  parameters.barometer_enabled = true;
  parameters.magnetometer_enabled = true;
  parameters.contact_enabled = true;
  parameters.camera_depth_enabled = true;
  auto scene = test::shipped_scene("gate_easy");
  scene.drone = test::shipped_drone("crazyflie");
  test::FlightRig rig(scene, parameters);
  rig.inputs.camera_trigger = 1;
  rig.run(0.1);
  const long before = allocations();
  for (int i = 2; i < 20; ++i) {
    rig.inputs.camera_trigger = i;
    rig.run(0.05);
  }
  EXPECT_EQ(allocations(), before);
}

TEST(WorldHeap, NetworksOfDownwashAllocateNothing) {
  auto parameters = test::FlightRig::small_camera();
  parameters.downwash_strength = 1.0;
  scene::DownwashNetworks networks;
  networks.force_per_output_n = 1e-3;
  networks.phi = {{6, 2, std::vector<double>(12, 0.1), {0.0, 0.1}}};
  networks.phi_ground = {{4, 2, std::vector<double>(8, 0.1), {0.0, 0.1}}};
  networks.rho = {{2, 3, std::vector<double>(6, 0.1), {0.0, 0.1, 0.2}}, {3, 1, {0.1, 0.2, 0.3}, {0.0}}};
  test::Fleet fleet(test::shipped_scene("empty"), parameters, {{0.0, 0.0, 5.0}, {0.1, 0.0, 6.0}}, networks);
  fleet.step();
  const long before = allocations();
  for (int i = 0; i < 100; ++i) fleet.world.step(fleet.time_ns + 2'000'000 * i, 2'000'000);
  EXPECT_EQ(allocations(), before);
}

}  // namespace
}  // namespace mebots::world
