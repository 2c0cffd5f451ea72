// SPDX-License-Identifier: Apache-2.0
#include "dynamics/airframe.hpp"

#include "mebots/error.hpp"
#include "support/flight_rig.hpp"

#include <gmock/gmock.h>

namespace mebots::world {
namespace {

const scene::Drone& airframe_drone() {
  static const scene::Drone d = test::shipped_scene("empty").drone;
  return d;
}

TEST(Airframe, EqualThrustsLiftWithoutTurning) {
  const Wrench w = rotor_wrench(airframe_drone(), {0.1, 0.1, 0.1, 0.1}, {1e-3, 1e-3, 1e-3, 1e-3});
  EXPECT_DOUBLE_EQ(w.force_n.z(), 0.4);
  EXPECT_EQ(w.force_n.head<2>().norm(), 0.0);
  EXPECT_NEAR(w.torque_n_m.norm(), 0.0, 1e-18);  // rounding of sums of 1e-3
}

TEST(Airframe, MoreThrustOnTheLeftRollsToTheRight) {
  // Rotors 3 (rear left) and 4 (front left). Roll is right-handed about x forward: the left side rises.
  const Wrench w = rotor_wrench(airframe_drone(), {0.0, 0.0, 0.1, 0.1}, {});
  EXPECT_DOUBLE_EQ(w.torque_n_m.x(), 0.2 * airframe_drone().arm_m);
  EXPECT_EQ(w.torque_n_m.y(), 0.0);
}

TEST(Airframe, MoreThrustAtTheRearPitchesNoseDown) {
  // Rotors 2 and 3 are at the rear; positive pitch is nose down.
  const Wrench w = rotor_wrench(airframe_drone(), {0.0, 0.1, 0.1, 0.0}, {});
  EXPECT_EQ(w.torque_n_m.x(), 0.0);
  EXPECT_DOUBLE_EQ(w.torque_n_m.y(), 0.2 * airframe_drone().arm_m);
}

TEST(Airframe, ClockwiseRotorsTurnTheBodyToTheLeft) {
  // Rotors 1 and 3 turn counter-clockwise seen from above, so rotors 2 and 4 exert a positive yaw torque on the body.
  EXPECT_DOUBLE_EQ(rotor_wrench(airframe_drone(), {}, {0.0, 1e-3, 0.0, 1e-3}).torque_n_m.z(), 2e-3);
  EXPECT_DOUBLE_EQ(rotor_wrench(airframe_drone(), {}, {1e-3, 0.0, 1e-3, 0.0}).torque_n_m.z(), -2e-3);
}

TEST(Airframe, InertiaAtTheReferenceMassIsTheMeasuredOne) {
  EXPECT_EQ(inertia_for(airframe_drone(), airframe_drone().reference_mass_kg), airframe_drone().inertia_kg_m2);
}

TEST(Airframe, EveryGramBeyondTheReferenceAddsThatOfABox) {
  const double extra_kg = 0.012;
  const Eigen::Vector3d added =
      inertia_for(airframe_drone(), airframe_drone().reference_mass_kg + extra_kg) - airframe_drone().inertia_kg_m2;
  const Eigen::Vector3d& a = airframe_drone().load_size_m;
  EXPECT_NEAR(added.z(), extra_kg / 12.0 * (a.x() * a.x() + a.y() * a.y()), 1e-18);  // rounding at 1e-5 kg m2
  EXPECT_NEAR(added.x(), extra_kg / 12.0 * (a.y() * a.y() + a.z() * a.z()), 1e-18);
}

TEST(Airframe, RefusesADroneWithoutMass) {
  EXPECT_THAT([] { inertia_for(airframe_drone(), 0.0); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("drone.dry_mass + cell.mass = 0")));
}

TEST(Airframe, DragIsAgainstTheMotionThroughTheAirAlongBodyAxes) {
  scene::Drone d = airframe_drone();
  d.drag_n_s_per_m = {0.01, 0.02, 0.03};
  RigidState state;
  state.q_WB = Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitZ());  // body x looks along world y
  state.v_WB_m_per_s = {1.0, 2.0, 3.0};
  const Eigen::Vector3d f = drag_force(d, state, {0.0, 1.0, 3.0});
  EXPECT_TRUE(f.isApprox(Eigen::Vector3d(-0.02 * 1.0, -0.01 * 1.0, 0.0), 1e-12)) << f.transpose();
}

TEST(Airframe, AirAtTheSpeedOfTheBodyCausesNoDrag) {
  RigidState state;
  state.v_WB_m_per_s = {1.0, 2.0, 3.0};
  EXPECT_EQ(drag_force(airframe_drone(), state, state.v_WB_m_per_s).norm(), 0.0);
}

}  // namespace
}  // namespace mebots::world
