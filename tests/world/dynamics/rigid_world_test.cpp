// SPDX-License-Identifier: Apache-2.0
#include "dynamics/rigid_world.hpp"

#include "mebots/error.hpp"
#include "support/flight_rig.hpp"
#include "support/one_body.hpp"

#include <gmock/gmock.h>
#include <algorithm>
#include <cmath>
#include <thread>

namespace mebots::world {
namespace {

constexpr double kMass_kg = 0.04;
const Eigen::Vector3d kNone = Eigen::Vector3d::Zero();

class FreeFlight : public testing::Test {
 protected:
  FreeFlight() : scene_(test::shipped_scene("empty")), inertia_(inertia_for(scene_.drone, kMass_kg)), bodies_(scene_) {
    bodies_.set_mass(kMass_kg, inertia_);
    state_.p_WB_m = {0.0, 0.0, 1000.0};
  }

  Eigen::Vector3d angular_momentum_W() const {
    return state_.q_WB * inertia_.cwiseProduct(state_.body_rate_rad_per_s());
  }
  double rotation_energy_j() const {
    const Eigen::Vector3d w = state_.body_rate_rad_per_s();
    return 0.5 * w.dot(inertia_.cwiseProduct(w));
  }
  /// Returns the largest relative changes of angular momentum and of rotational energy in a second of tumbling without
  /// torque.
  std::pair<double, double> drift(double dt_s) {
    state_ = {};
    state_.p_WB_m = {0.0, 0.0, 1000.0};
    state_.w_WB_W_rad_per_s = {4.0, 1.0, 2.0};
    const Eigen::Vector3d momentum = angular_momentum_W();
    const double energy_j = rotation_energy_j();
    std::pair<double, double> worst{0.0, 0.0};
    for (int i = 0; i < std::lround(1.0 / dt_s); ++i) {
      bodies_.step(state_, kNone, kNone, dt_s);
      worst.first = std::max(worst.first, (angular_momentum_W() - momentum).norm() / momentum.norm());
      worst.second = std::max(worst.second, std::abs(rotation_energy_j() / energy_j - 1.0));
    }
    return worst;
  }

  scene::Scene scene_;
  Eigen::Vector3d inertia_;
  test::OneBody bodies_;
  RigidState state_;
};

TEST_F(FreeFlight, FallsAsTheSemiImplicitRuleOfFreeFallSays) {
  const double dt_s = 1e-3;
  for (int i = 0; i < 1000; ++i) bodies_.step(state_, kNone, kNone, dt_s);
  // v is exact. z differs from -g t^2 / 2 by g t dt / 2. Tolerance: rounding of 1000 additions at 1000 m.
  EXPECT_NEAR(state_.v_WB_m_per_s.z(), -kGravity_m_per_s2, 1e-11);
  EXPECT_NEAR(state_.p_WB_m.z(), 1000.0 - 0.5 * kGravity_m_per_s2 * (1.0 + dt_s), 1e-9);
  EXPECT_EQ(state_.p_WB_m.head<2>().norm(), 0.0);
}

TEST_F(FreeFlight, PositionConvergesWithFirstOrder) {
  const auto error = [&](double dt_s) {
    state_ = {};
    state_.p_WB_m.z() = 1000.0;
    for (int i = 0; i < std::lround(1.0 / dt_s); ++i) bodies_.step(state_, kNone, kNone, dt_s);
    return std::abs(state_.p_WB_m.z() - (1000.0 - 0.5 * kGravity_m_per_s2));
  };
  EXPECT_NEAR(error(2e-3) / error(1e-3), 2.0, 1e-4);  // rounding at 1000 m, compared with an error of 5 mm
}

TEST_F(FreeFlight, HoversWhenThrustIsTheWeight) {
  for (int i = 0; i < 1000; ++i) bodies_.step(state_, {0.0, 0.0, kMass_kg * kGravity_m_per_s2}, kNone, 1e-3);
  EXPECT_NEAR(state_.v_WB_m_per_s.norm(), 0.0, 1e-12);  // rounding of the sum of forces
  EXPECT_NEAR(state_.p_WB_m.z(), 1000.0, 1e-9);
}

TEST_F(FreeFlight, SpinsUpAboutAnAxisAsTorqueOverInertiaSays) {
  for (int i = 0; i < 100; ++i) bodies_.step(state_, kNone, {0.0, 0.0, 1e-4}, 1e-3);
  EXPECT_NEAR(state_.body_rate_rad_per_s().z(), 1e-4 * 0.1 / inertia_.z(), 1e-9);
}

TEST_F(FreeFlight, TumblingKeepsMomentumAndEnergyUpToFirstOrder) {
  const auto coarse = drift(1e-3);
  const auto fine = drift(5e-4);
  // Measured at a step of 1 ms: momentum changes by 0.4 % and energy by 0.2 % in a second. Each bound is more than
  // twice the measured value.
  EXPECT_LT(coarse.first, 1e-2);
  EXPECT_LT(coarse.second, 1e-2);
  EXPECT_NEAR(coarse.first / fine.first, 2.0, 0.1);
  EXPECT_NEAR(coarse.second / fine.second, 2.0, 0.1);
}

TEST_F(FreeFlight, ApproachesTheTerminalSpeedOfLinearDrag) {
  const double dt_s = 1e-2;
  const double lag_s = kMass_kg / scene_.drone.drag_n_s_per_m.z();
  state_.p_WB_m.z() = 2000.0;
  double t_s = 0.0;
  for (int i = 0; i < 3000; ++i, t_s += dt_s)
    bodies_.step(state_, drag_force(scene_.drone, state_, kNone), kNone, dt_s);
  const double terminal = kGravity_m_per_s2 * lag_s;
  // Explicit Euler on v' = g - v / lag has an error of about dt / (2 lag) = 0.2 % of the difference from the terminal
  // speed.
  const double exact = -terminal * (1.0 - std::exp(-t_s / lag_s));
  EXPECT_NEAR(state_.v_WB_m_per_s.z(), exact, 1e-5 * terminal);
}

TEST_F(FreeFlight, WindCarriesTheDroneAlong) {
  const Eigen::Vector3d wind{3.0, -2.0, 0.0};
  const Eigen::Vector3d lift{0.0, 0.0, kMass_kg * kGravity_m_per_s2};
  for (int i = 0; i < 5000; ++i) bodies_.step(state_, lift + drag_force(scene_.drone, state_, wind), kNone, 1e-2);
  EXPECT_TRUE(state_.v_WB_m_per_s.isApprox(wind, 1e-6)) << state_.v_WB_m_per_s.transpose();
}

TEST_F(FreeFlight, RefusesAStateThatIsNotFinite) {
  state_.v_WB_m_per_s.x() = std::nan("");
  EXPECT_THROW(bodies_.step(state_, kNone, kNone, 1e-3), Error);
}

TEST_F(FreeFlight, RefusesFiniteNumbersWhoseProductsAreNot) {
  for (const double huge : {1e40, 1e155, 1e308}) {
    EXPECT_THROW(bodies_.step(state_, {huge, 0.0, 0.0}, kNone, 1e-3), Error) << huge;
    EXPECT_THROW(bodies_.step(state_, kNone, {0.0, -huge, 0.0}, 1e-3), Error) << huge;
    for (auto member : {&RigidState::p_WB_m, &RigidState::v_WB_m_per_s, &RigidState::w_WB_W_rad_per_s}) {
      RigidState far = state_;
      (far.*member).x() = huge;
      EXPECT_THROW(bodies_.step(far, kNone, kNone, 1e-3), Error) << huge;
    }
    bodies_.set_mass(huge, inertia_);
    EXPECT_THROW(bodies_.step(state_, kNone, kNone, 1e-3), Error) << huge;
    bodies_.set_mass(kMass_kg, inertia_);
  }
}

TEST_F(FreeFlight, RefusesAHugeMomentOfInertiaAboutAnyAxis) {
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d huge = inertia_;
    huge[axis] = 1e155;
    bodies_.set_mass(kMass_kg, huge);
    EXPECT_THROW(bodies_.step(state_, kNone, kNone, 1e-3), Error) << axis;
  }
}

TEST_F(FreeFlight, ContinuesJustBelowTheLimit) {
  state_.w_WB_W_rad_per_s.x() = 9e39;
  for (int i = 0; i < 10; ++i) bodies_.step(state_, {9e39, 0.0, 0.0}, kNone, 1e-3);
  EXPECT_TRUE(state_.is_finite());
}

TEST_F(FreeFlight, RefusesForcesThatAreNotFinite) {
  EXPECT_THROW(bodies_.step(state_, {0.0, 0.0, INFINITY}, kNone, 1e-3), Error);
}

/// Returns the state of a drone after some steps of falling and tumbling to the ground.
RigidState tumble(int steps, RigidState state = {}, bool fresh = true) {
  const auto scene = test::shipped_scene("gate_easy");
  test::OneBody bodies(scene);
  bodies.set_mass(kMass_kg, inertia_for(scene.drone, kMass_kg));
  if (fresh) {
    state.p_WB_m = {4.9, 0.41, 1.2};  // onto the gate's left upright, then to the ground
    state.v_WB_m_per_s = {0.5, 0.1, 0.0};
    state.w_WB_W_rad_per_s = {3.0, -2.0, 1.0};
  }
  for (int i = 0; i < steps; ++i) bodies.step(state, kNone, kNone, 1e-3);
  return state;
}

bool same_bits(const RigidState& a, const RigidState& b) {
  return a.p_WB_m == b.p_WB_m && a.q_WB.coeffs() == b.q_WB.coeffs() && a.v_WB_m_per_s == b.v_WB_m_per_s &&
         a.w_WB_W_rad_per_s == b.w_WB_W_rad_per_s;
}

TEST(Contact, ContinuesWithTheSameBitsFromAnyStateDuringImpacts) {
  const RigidState straight = tumble(1500);
  for (const int half : {120, 480, 510, 900}) {
    EXPECT_TRUE(same_bits(tumble(1500 - half, tumble(half), false), straight)) << "cut after " << half << " steps";
  }
}

TEST(Contact, GivesTheSameBitsInThreadsAsAlone) {
  const RigidState alone = tumble(1500);
  std::array<RigidState, 4> results;
  std::vector<std::thread> threads;
  for (auto& result : results) threads.emplace_back([&result] { result = tumble(1500); });
  for (auto& thread : threads) thread.join();
  for (const auto& result : results) EXPECT_TRUE(same_bits(result, alone));
}

class OnTheGround : public FreeFlight {
 protected:
  OnTheGround() { state_.p_WB_m = {0.0, 0.0, 0.0145}; }
};

TEST_F(OnTheGround, RestsAtHalfItsHeight) {
  for (int i = 0; i < 2000; ++i) bodies_.step(state_, kNone, kNone, 1e-3);
  EXPECT_NEAR(state_.p_WB_m.z(), 0.0145, 1e-5);  // penetration of the soft contact, some micrometres
  EXPECT_LT(state_.v_WB_m_per_s.norm(), 1e-6);
}

TEST_F(OnTheGround, FrictionHoldsAgainstLessThanTheWeightTimesMu) {
  const double weight_n = kMass_kg * kGravity_m_per_s2;
  for (int i = 0; i < 1000; ++i) bodies_.step(state_, {0.8 * weight_n, 0.0, 0.0}, kNone, 1e-3);
  EXPECT_LT(std::abs(state_.v_WB_m_per_s.x()), 5e-3);  // soft contact creeps
}

TEST_F(OnTheGround, SlidesUnderMoreThanTheWeightTimesMu) {
  const double weight_n = kMass_kg * kGravity_m_per_s2;
  for (int i = 0; i < 200; ++i) bodies_.step(state_, {1.5 * weight_n, 0.0, 0.0}, kNone, 1e-3);
  // The force is 1.5 times the weight, so a = (1.5 - mu) g with mu = 1. A margin of a tenth permits bounces,
  // because the force acts on the box's centre.
  EXPECT_NEAR(state_.v_WB_m_per_s.x(), 0.5 * kGravity_m_per_s2 * 0.2, 0.1 * 0.5 * kGravity_m_per_s2 * 0.2);
}

TEST_F(OnTheGround, BouncesWithTheRestitutionThatSoftContactLeaves) {
  // Four equal contacts share the impulse. soft_cfm makes each of them yield by cfm / dt per unit of impulse. Therefore
  // only the share (4 / m) / (4 / m + cfm / dt) of the required change of speed (1 + e) v is reached.
  for (const double dt_s : {1e-3, 1e-4}) {
    state_ = {};
    state_.p_WB_m.z() = 0.0145 + 0.05;
    double down = 0.0;
    double up = 0.0;
    for (int i = 0; i < std::lround(0.14 / dt_s); ++i) {
      bodies_.step(state_, kNone, kNone, dt_s);
      down = std::max(down, -state_.v_WB_m_per_s.z());
      up = std::max(up, state_.v_WB_m_per_s.z());
    }
    const double stiff = 4.0 / kMass_kg;
    const double share = stiff / (stiff + scene_.contact.soft_cfm / dt_s);
    const double step_speed = kGravity_m_per_s2 * dt_s;
    EXPECT_NEAR(down, std::sqrt(2.0 * kGravity_m_per_s2 * 0.05), 2.0 * step_speed);
    EXPECT_NEAR(up, ((1.0 + scene_.contact.bounce) * share - 1.0) * down, 2.0 * step_speed);
  }
}

TEST_F(OnTheGround, ReportsTheClosingSpeedOfATouch) {
  state_.p_WB_m.z() = 0.0144;
  state_.v_WB_m_per_s = {0.3, 0.0, -0.7};
  const auto& touches = bodies_.touches_at(state_);
  ASSERT_EQ(touches.size(), 4U);
  for (const auto& touch : touches) {
    EXPECT_EQ(touch.what, Touch::What::ground);
    EXPECT_NEAR(touch.closing_speed_m_per_s, 0.7, 1e-12);
    EXPECT_NEAR(touch.depth_m, 1e-4, 1e-12);
    EXPECT_NEAR(touch.normal_W.z(), 1.0, 1e-12);
  }
}

}  // namespace
}  // namespace mebots::world
