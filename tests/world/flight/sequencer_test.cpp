// SPDX-License-Identifier: Apache-2.0
#include "flight/sequencer.hpp"

#include <gtest/gtest.h>

namespace mebots::world {
namespace {

constexpr double kDt_s = 1e-3;

Situation aloft(double altitude_m, double climb_m_per_s = 0.0) {
  return {false, false, altitude_m, climb_m_per_s, std::abs(climb_m_per_s)};
}
Situation at_rest() {
  return {true, false, 0.0145, 0.0, 0.0};
}

TEST(Sequencer, StaysOnTheGroundWithMotorsOffUntilCommanded) {
  Sequencer sequencer(true);
  for (const auto mode : {FlightMode::off, FlightMode::land}) {
    sequencer.update(mode, 1.0, at_rest(), kDt_s);
    EXPECT_EQ(sequencer.phase(), FlightPhase::on_ground);
    EXPECT_FALSE(sequencer.motors_on());
  }
}

TEST(Sequencer, ClimbsAndThenFlies) {
  Sequencer sequencer(true);
  sequencer.update(FlightMode::take_off, 1.0, at_rest(), kDt_s);
  EXPECT_EQ(sequencer.phase(), FlightPhase::climbing);
  EXPECT_TRUE(sequencer.motors_on());
  sequencer.update(FlightMode::take_off, 1.0, aloft(1.0, 0.4), kDt_s);  // too fast to count as arrived
  EXPECT_EQ(sequencer.phase(), FlightPhase::climbing);
  sequencer.update(FlightMode::take_off, 1.0, aloft(0.96, 0.05), kDt_s);
  EXPECT_EQ(sequencer.phase(), FlightPhase::flying);
}

TEST(Sequencer, CutsTheMotorsAtTheFirstTouchAndHasLandedOnceAtRest) {
  Sequencer sequencer(false);
  sequencer.update(FlightMode::land, 1.0, aloft(1.0), kDt_s);
  EXPECT_EQ(sequencer.phase(), FlightPhase::descending);
  EXPECT_TRUE(sequencer.motors_on());
  sequencer.update(FlightMode::land, 1.0, {true, false, 0.0145, -0.3, 0.3}, kDt_s);
  EXPECT_FALSE(sequencer.motors_on());
  sequencer.update(FlightMode::land, 1.0, aloft(0.016, 0.1), kDt_s);  // a small bounce does not restart the motors
  EXPECT_FALSE(sequencer.motors_on());
  EXPECT_EQ(sequencer.phase(), FlightPhase::descending);
  for (int i = 0; i < 250; ++i) sequencer.update(FlightMode::land, 1.0, at_rest(), kDt_s);
  EXPECT_EQ(sequencer.phase(), FlightPhase::landed);
}

TEST(Sequencer, TakesOffAgainAfterALanding) {
  Sequencer sequencer(false);
  for (int i = 0; i < 250; ++i) sequencer.update(FlightMode::land, 1.0, at_rest(), kDt_s);
  ASSERT_EQ(sequencer.phase(), FlightPhase::landed);
  sequencer.update(FlightMode::take_off, 1.0, at_rest(), kDt_s);
  EXPECT_EQ(sequencer.phase(), FlightPhase::climbing);
  EXPECT_TRUE(sequencer.motors_on());
}

TEST(Sequencer, GoesAroundFromADescent) {
  Sequencer sequencer(false);
  sequencer.update(FlightMode::land, 1.0, aloft(0.5, -0.3), kDt_s);
  sequencer.update(FlightMode::fly, 1.0, aloft(0.5, -0.3), kDt_s);
  EXPECT_EQ(sequencer.phase(), FlightPhase::flying);
  EXPECT_TRUE(sequencer.motors_on());
}

TEST(Sequencer, OffStopsTheMotorsInTheAir) {
  Sequencer sequencer(false);
  sequencer.update(FlightMode::off, 1.0, aloft(1.0), kDt_s);
  EXPECT_EQ(sequencer.phase(), FlightPhase::descending);
  EXPECT_FALSE(sequencer.motors_on());
}

TEST(Sequencer, ACrashIsForGood) {
  Sequencer sequencer(false);
  Situation crash = aloft(1.0);
  crash.crashed = true;
  sequencer.update(FlightMode::fly, 1.0, crash, kDt_s);
  for (const auto mode : {FlightMode::fly, FlightMode::take_off, FlightMode::land, FlightMode::off}) {
    sequencer.update(mode, 1.0, at_rest(), kDt_s);
    EXPECT_EQ(sequencer.phase(), FlightPhase::crashed);
    EXPECT_FALSE(sequencer.motors_on());
  }
}

}  // namespace
}  // namespace mebots::world
