// SPDX-License-Identifier: Apache-2.0
#include "flight/gate_judge.hpp"

#include "mebots/error.hpp"

#include <gtest/gtest.h>
#include <cmath>

namespace mebots::world {
namespace {

scene::Gate gate_at(double x_m, double yaw_rad = 0.0) {
  scene::Gate gate;
  gate.p_W_m = {x_m, 0.0, 1.0};
  gate.yaw_rad = yaw_rad;
  return gate;
}

TEST(GateJudge, PassesThroughTheOpeningFromTheFront) {
  GateJudge judge({gate_at(2.0)});
  EXPECT_FALSE(judge.move({0.0, 0.0, 1.0}, {1.9, 0.0, 1.0}));
  const auto crossing = judge.move({1.9, 0.1, 1.0}, {2.1, 0.1, 1.0});
  ASSERT_TRUE(crossing);
  EXPECT_TRUE(crossing->passed);
  EXPECT_TRUE(judge.all_passed());
  EXPECT_FALSE(judge.missed());
  EXPECT_NEAR(judge.lateral_error_m(), 0.1, 1e-15);
}

TEST(GateJudge, OpeningEndsAtItsEdgeToATenthOfAMillimetre) {
  for (const double sign : {1.0, -1.0}) {
    GateJudge inside({gate_at(2.0)});
    EXPECT_TRUE(inside.move({1.9, sign * 0.1999, 1.0}, {2.1, sign * 0.1999, 1.0})->passed);
    GateJudge outside({gate_at(2.0)});
    EXPECT_FALSE(outside.move({1.9, sign * 0.2001, 1.0}, {2.1, sign * 0.2001, 1.0})->passed);
    EXPECT_TRUE(outside.missed());
    GateJudge low({gate_at(2.0)});
    EXPECT_FALSE(low.move({1.9, 0.0, 1.0 + sign * 0.2001}, {2.1, 0.0, 1.0 + sign * 0.2001})->passed);
  }
}

TEST(GateJudge, JudgesThePointOnThePlaneNotTheEndOfTheMove) {
  GateJudge judge({gate_at(2.0)});
  // At the plane y is 0.1, at the end 0.5.
  EXPECT_TRUE(judge.move({1.9, 0.0, 1.0}, {2.4, 0.5, 1.0})->passed);
  EXPECT_NEAR(judge.lateral_error_m(), 0.1, 1e-12);
}

TEST(GateJudge, FlyingThroughFromBehindIsNoPassage) {
  GateJudge judge({gate_at(2.0)});
  EXPECT_FALSE(judge.move({2.1, 0.0, 1.0}, {1.9, 0.0, 1.0}));
  EXPECT_FALSE(judge.all_passed());
}

TEST(GateJudge, AMissedGateMayStillBePassedLater) {
  GateJudge judge({gate_at(2.0)});
  EXPECT_FALSE(judge.move({1.9, 1.0, 1.0}, {2.1, 1.0, 1.0})->passed);
  EXPECT_FALSE(judge.move({2.1, 0.0, 1.0}, {1.9, 0.0, 1.0}));
  EXPECT_TRUE(judge.move({1.9, 0.0, 1.0}, {2.1, 0.0, 1.0})->passed);
  EXPECT_TRUE(judge.missed());
  EXPECT_TRUE(judge.all_passed());
}

TEST(GateJudge, GatesCountInTheirOrder) {
  GateJudge judge({gate_at(2.0), gate_at(4.0)});
  EXPECT_FALSE(judge.move({3.9, 0.0, 1.0}, {4.1, 0.0, 1.0}));  // the second one first: nobody looks
  EXPECT_TRUE(judge.move({1.9, 0.0, 1.0}, {2.1, 0.0, 1.0})->passed);
  EXPECT_FALSE(judge.all_passed());
  EXPECT_NEAR(judge.distance_m({2.1, 0.0, 1.0}), 1.9, 1e-12);
  EXPECT_TRUE(judge.move({3.9, 0.0, 1.0}, {4.1, 0.0, 1.0})->passed);
  EXPECT_TRUE(judge.all_passed());
  EXPECT_NEAR(judge.distance_m({4.5, 0.0, 1.0}), -0.5, 1e-12);
}

TEST(GateJudge, LateralErrorIsToTheLeftAsFlown) {
  // Flown along world -y: left is world +x.
  GateJudge judge({gate_at(2.0, -0.5 * M_PI)});
  const auto crossing = judge.move({2.05, 0.1, 1.0}, {2.05, -0.1, 1.0});
  ASSERT_TRUE(crossing);
  EXPECT_NEAR(crossing->lateral_m, 0.05, 1e-12);
}

TEST(GateJudge, ASceneWithoutGatesIsNeverPassed) {
  GateJudge judge({});
  EXPECT_FALSE(judge.move({0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}));
  EXPECT_FALSE(judge.all_passed());
  EXPECT_EQ(judge.distance_m({0.0, 0.0, 0.0}), 0.0);
}

TEST(GateJudge, RefusesAStateOfASceneWithMoreGates) {
  GateJudge two({gate_at(2.0), gate_at(4.0)});
  two.move({1.9, 0.0, 1.0}, {2.1, 0.0, 1.0});
  two.move({3.9, 0.0, 1.0}, {4.1, 0.0, 1.0});
  state::Writer writer;
  two.save(writer);
  GateJudge one({gate_at(2.0)});
  state::Reader reader(writer.bytes());
  EXPECT_THROW(one.restore(reader), Error);
}

}  // namespace
}  // namespace mebots::world
