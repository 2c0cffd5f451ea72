// SPDX-License-Identifier: Apache-2.0
#include "dynamics/rigid_world.hpp"
#include "math/rotation.hpp"
#include "support/flight_rig.hpp"
#include "support/one_body.hpp"

#include <gtest/gtest.h>

/// Tests contacts between the drone's box and the gate's frame to a tenth of a millimetre. The opening is 0.40 m wide.
/// The drone is 0.092 m wide and 0.029 m high, so the clearance is 0.154 m on each side, and 0.1855 m above and below.
namespace mebots::world {
namespace {

constexpr double kClose_m = 1e-4;

class GateGeometry : public testing::Test {
 protected:
  GateGeometry() : scene_(test::shipped_scene("gate_easy")), bodies_(scene_) {
    bodies_.set_mass(0.04, inertia_for(scene_.drone, 0.04));
  }

  /// True if a drone with its centre at (x, y, z) in the gate's coordinates touches the gate. The drone is aligned with
  /// the gate.
  bool touches(double x_m, double y_m, double z_m) {
    RigidState state;
    const auto& gate = scene_.gates[0];
    state.q_WB = yaw_rotation(gate.yaw_rad);
    state.p_WB_m = gate.p_W_m + state.q_WB * Eigen::Vector3d(x_m, y_m, z_m);
    for (const Touch& touch : bodies_.touches_at(state)) {
      if (touch.what == Touch::What::gate) return true;
    }
    return false;
  }

  scene::Scene scene_;
  test::OneBody bodies_;
};

TEST_F(GateGeometry, LowerEdgeOfTheOpeningIs83CentimetresUp) {
  EXPECT_DOUBLE_EQ(scene_.gates[0].p_W_m.z() - 0.5 * scene_.gates[0].inner_m, 0.83);
  EXPECT_DOUBLE_EQ(scene_.gates[0].inner_m, 0.40);
  EXPECT_DOUBLE_EQ(scene_.gates[0].outer_m, 0.60);
  EXPECT_DOUBLE_EQ(scene_.gates[0].thickness_m, 0.03);
}

TEST_F(GateGeometry, MiddleIsFree) {
  EXPECT_FALSE(touches(0.0, 0.0, 0.0));
}

TEST_F(GateGeometry, TouchesTheUprightsWhereTheDronesSideMeetsThem) {
  for (const double side : {1.0, -1.0}) {
    EXPECT_FALSE(touches(0.0, side * (0.154 - kClose_m), 0.0));
    EXPECT_TRUE(touches(0.0, side * (0.154 + kClose_m), 0.0));
  }
}

TEST_F(GateGeometry, TouchesTheUpperAndLowerBeamWhereTheDroneMeetsThem) {
  for (const double side : {1.0, -1.0}) {
    EXPECT_FALSE(touches(0.0, 0.0, side * (0.1855 - kClose_m)));
    EXPECT_TRUE(touches(0.0, 0.0, side * (0.1855 + kClose_m)));
  }
}

TEST_F(GateGeometry, TouchesTheFrontAndTheBackOfABeamAtHalfItsThickness) {
  for (const double side : {1.0, -1.0}) {
    EXPECT_FALSE(touches(side * (0.046 + 0.015 + kClose_m), 0.25, 0.0));
    EXPECT_TRUE(touches(side * (0.046 + 0.015 - kClose_m), 0.25, 0.0));
  }
}

TEST_F(GateGeometry, OutsideOfTheFrameIsFree) {
  for (const double side : {1.0, -1.0}) {
    EXPECT_FALSE(touches(0.0, side * (0.30 + 0.046 + kClose_m), 0.0));
    EXPECT_TRUE(touches(0.0, side * (0.30 + 0.046 - kClose_m), 0.0));
    EXPECT_FALSE(touches(0.0, 0.0, side * (0.30 + 0.0145 + kClose_m)));
    EXPECT_TRUE(touches(0.0, 0.0, side * (0.30 + 0.0145 - kClose_m)));
  }
}

TEST_F(GateGeometry, CornersOfTheFrameAreSolid) {
  EXPECT_TRUE(touches(0.0, 0.25, 0.25));
  EXPECT_TRUE(touches(0.0, -0.25, -0.25));
}

TEST(GateBeams, FillTheFrameExactlyOnceForAnyYaw) {
  scene::Gate gate;
  gate.p_W_m = {1.0, 2.0, 3.0};
  gate.yaw_rad = 0.7;
  double volume_m3 = 0.0;
  for (const auto& beam : gate.beams()) volume_m3 += beam.size_m.prod();
  EXPECT_NEAR(volume_m3, (0.6 * 0.6 - 0.4 * 0.4) * 0.03, 1e-15);  // rounding of sums of 1e-3 m3
  // The first beam is on the left in the direction of flight.
  const Eigen::Vector3d left = yaw_rotation(gate.yaw_rad) * Eigen::Vector3d(0.0, 0.25, 0.0);
  EXPECT_TRUE(gate.beams()[0].p_W_m.isApprox(gate.p_W_m + left, 1e-12));
}

}  // namespace
}  // namespace mebots::world
