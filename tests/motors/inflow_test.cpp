// SPDX-License-Identifier: Apache-2.0
#include "inflow.hpp"

#include "mebots/error.hpp"
#include "model.hpp"
#include "support.hpp"

#include <gtest/gtest.h>
#include <cmath>

namespace mebots::motors {
namespace {

constexpr double kThrust_n = 0.0981;  // a quarter of 40 g
constexpr double kRadius_m = 0.02355;

Inflow at(double speed, double climb) {
  return {kThrust_n, 1.225, kRadius_m, speed, climb};
}

TEST(Inflow, HoverIsFroudesVelocity) {
  EXPECT_NEAR(at(0, 0).hover_velocity(), 4.79, 0.01);
  EXPECT_NEAR(at(0, 0).induced_velocity(), at(0, 0).hover_velocity(), 1e-12);
  EXPECT_NEAR(at(0, 0).power_beyond_hover_w(), 0, 1e-12);
}

TEST(Inflow, ClimbFollowsTheClosedForm) {
  // In vertical flight, v_i solves v_i^2 + V_c v_i = v_h^2.
  const double v_h = at(0, 0).hover_velocity();
  for (const double climb : {-4.0, -1.0, 0.5, 3.0}) {
    EXPECT_NEAR(at(0, climb).induced_velocity(), -0.5 * climb + std::sqrt(0.25 * climb * climb + v_h * v_h),
                climb < 0 && -climb > v_h ? 1 : 1e-9);
  }
}

TEST(Inflow, FastForwardFlightTendsToGlauertsLimit) {
  const double v_h = at(0, 0).hover_velocity();
  EXPECT_NEAR(at(50, 0).induced_velocity(), v_h * v_h / 50, 1e-4);
}

TEST(Inflow, TheMissionsSpeedsHardlyChangePower) {
  const double hover_w = kThrust_n * at(0, 0).hover_velocity();
  const double change = at(1.5 / 3.6, 0).power_beyond_hover_w() / hover_w;
  EXPECT_LT(change, 0);
  EXPECT_GT(change, -0.005);
  // A climb at 0.5 m/s takes 5 % more: the work against the weight, less the reduction of the induced power.
  EXPECT_NEAR(at(0, 0.5).power_beyond_hover_w() / hover_w, 0.0535, 5e-4);
}

TEST(Inflow, ARotorWithoutDriveTakesNone) {
  Parameters parameters;
  parameters.inflow = true;
  Stand stand(parameters);
  stand.command(1);
  stand.inputs.body_climb_m_per_s = 3;
  stand.settle();
  const double of_four_w = stand.outputs.inflow_power_w;
  ASSERT_GT(of_four_w, 0.1);
  stand.inputs.rotor_command = {1, 0, 0, 0};  // the other rotors keep turning and produce lift
  stand.step(kMillisecond);
  EXPECT_GT(stand.outputs.rotor_thrust_n[1], 0.9 * stand.outputs.rotor_thrust_n[0]);
  EXPECT_NEAR(stand.outputs.inflow_power_w, of_four_w / 4, 1e-9);
}

TEST(Inflow, NoThrustTakesNoPower) {
  EXPECT_EQ((Inflow{0, 1.225, kRadius_m, 1, 2}).power_beyond_hover_w(), 0);
}

}  // namespace
}  // namespace mebots::motors
