// SPDX-License-Identifier: Apache-2.0
#include "flight/gate_judge.hpp"

#include "mebots/error.hpp"
#include "mebots/state/save.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

namespace mebots::world {
namespace {

using Kind = GateEvent::Kind;

const Eigen::Vector3d kBody_m{0.092, 0.092, 0.029};
constexpr std::int64_t kSecond_ns = 1'000'000'000;

GateFrame gate_at(double x_m, const Eigen::Matrix3d& R_WG = Eigen::Matrix3d::Identity()) {
  scene::Gate gate;
  gate.p_W_m = {x_m, 0.0, 1.0};
  GateFrame frame(gate);
  frame.R_WG = R_WG;
  return frame;
}

/// A drone that the test moves. Positions are in the first gate's coordinates.
class Puppet {
 public:
  explicit Puppet(const std::vector<GateFrame>& gates, const Eigen::Quaterniond& q_WB = Eigen::Quaterniond::Identity())
      : gate_(gates.front()), judge(gates, kBody_m) {
    at.q_WB = q_WB;
    at.p_WB_m = world({-1.0, 0.0, 0.0});
  }

  /// Moves the drone along a straight line in steps of a millimetre. Returns the events.
  std::vector<Kind> fly(const Eigen::Vector3d& to_G_m) {
    std::vector<Kind> kinds;
    const Eigen::Vector3d from_W_m = at.p_WB_m;
    const Eigen::Vector3d to_W_m = world(to_G_m);
    const int count = std::max(1, static_cast<int>((to_W_m - from_W_m).norm() / 1e-3));
    for (int i = 1; i <= count; ++i) {
      RigidState next = at;
      next.p_WB_m = from_W_m + static_cast<double>(i) / count * (to_W_m - from_W_m);
      if (const auto event = judge.move(at, next)) kinds.push_back(event->kind);
      at = next;
    }
    return kinds;
  }

  Eigen::Vector3d world(const Eigen::Vector3d& p_G_m) const { return gate_.p_WG_m + gate_.R_WG * p_G_m; }

 private:
  GateFrame gate_;

 public:
  GateJudge judge;
  RigidState at;
};

using Events = std::vector<Kind>;

struct Pose {
  const char* name;
  double gate_yaw_rad, gate_pitch_rad, drone_yaw_rad, drone_pitch_rad;
};

/// Tests gates and drones in many orientations.
class AnyPose : public ::testing::TestWithParam<Pose> {
 protected:
  static Eigen::Matrix3d turned(double yaw_rad, double pitch_rad) {
    return (Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) *
            Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()))
        .toRotationMatrix();
  }
  static Eigen::Matrix3d gate() { return turned(GetParam().gate_yaw_rad, GetParam().gate_pitch_rad); }
  static Puppet puppet() {
    const Eigen::Matrix3d drone = turned(GetParam().drone_yaw_rad, GetParam().drone_pitch_rad);
    return Puppet({gate_at(2.0, gate())}, Eigen::Quaterniond(drone));
  }
};

INSTANTIATE_TEST_SUITE_P(GateJudge, AnyPose,
                         ::testing::Values(Pose{"Straight", 0.0, 0.0, 0.0, 0.0}, Pose{"Yawed", 0.7, 0.0, 0.9, 0.3},
                                           Pose{"Reversed", M_PI, 0.0, -2.0, 0.0},
                                           Pose{"Pitched", -1.5, -0.5, 0.9, -0.2},
                                           Pose{"LyingFlat", 2.5, M_PI / 2, 0.3, 0.1}),
                         [](const auto& entry) { return std::string(entry.param.name); });

TEST_P(AnyPose, ThroughTheOpeningAndOnIsPassed) {
  Puppet drone = puppet();
  EXPECT_EQ(drone.fly({1.0, 0.1, -0.05}), Events{Kind::crossed});
  EXPECT_TRUE(drone.judge.crossed());
  EXPECT_TRUE(drone.judge.passed());
  EXPECT_TRUE(drone.judge.reached());
  EXPECT_FALSE(drone.judge.missed() || drone.judge.turned_back() || drone.judge.stuck() || drone.judge.touched());
  EXPECT_NEAR(drone.judge.lateral_error_m(), 0.05, 1e-9) << "half way to where it flew";
}

TEST_P(AnyPose, ThroughAndBackIsTurnedBack) {
  Puppet drone = puppet();
  drone.fly({0.5, 0.0, 0.0});
  EXPECT_EQ(drone.fly({-0.5, 0.0, 0.0}), Events{Kind::turned_back});
  EXPECT_TRUE(drone.judge.crossed()) << "once crossed stays crossed";
  EXPECT_TRUE(drone.judge.turned_back());
  EXPECT_FALSE(drone.judge.passed());
}

TEST_P(AnyPose, ThroughAndBackRoundTheFrameIsTurnedBack) {
  Puppet drone = puppet();
  drone.fly({0.5, 0.0, 0.0});
  EXPECT_EQ(drone.fly({0.5, 2.0, 0.0}), Events{});
  EXPECT_EQ(drone.fly({-0.5, 2.0, 0.0}), Events{Kind::turned_back});
  EXPECT_FALSE(drone.judge.passed());
}

TEST_P(AnyPose, ThroughAndOnlyAHandBackIsTurnedBack) {
  // The drone's centre moves a centimetre beyond the gate's plane. Then the drone flies back.
  Puppet drone = puppet();
  drone.fly({0.01, 0.0, 0.0});
  EXPECT_TRUE(drone.judge.crossed());
  EXPECT_FALSE(drone.judge.passed()) << "half of it is still in front of the plane";
  EXPECT_EQ(drone.fly({-0.1, 0.0, 0.0}), Events{Kind::turned_back});
}

TEST_P(AnyPose, PassesIfTheDroneCrossesAgainAfterTurningBack) {
  Puppet drone = puppet();
  drone.fly({0.5, 0.0, 0.0});
  drone.fly({-0.5, 0.0, 0.0});
  EXPECT_EQ(drone.fly({0.5, 0.0, 0.0}), Events{Kind::crossed});
  EXPECT_TRUE(drone.judge.passed());
  EXPECT_TRUE(drone.judge.turned_back()) << "it did come back";
}

TEST_P(AnyPose, DoesNotPassIfTheDroneFliesPastAfterTurningBack) {
  Puppet drone = puppet();
  drone.fly({0.5, 0.0, 0.0});
  drone.fly({-0.5, 0.0, 0.0});
  drone.fly({-0.5, 0.5, 0.0});
  EXPECT_EQ(drone.fly({0.5, 0.5, 0.0}), Events{Kind::missed});
  EXPECT_FALSE(drone.judge.passed());
  EXPECT_NEAR(drone.judge.lateral_error_m(), 0.5, 1e-9) << "of the last time that it crossed the plane";
}

TEST_P(AnyPose, TremblingInThePlaneIsOneCrossing) {
  Puppet drone = puppet();
  EXPECT_EQ(drone.fly({0.005, 0.0, 0.0}), Events{Kind::crossed});
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(drone.fly({-0.005, 0.01, 0.0}), Events{});
    EXPECT_EQ(drone.fly({0.005, 0.0, 0.0}), Events{});
  }
  EXPECT_FALSE(drone.judge.turned_back());
  EXPECT_FALSE(drone.judge.passed());
  drone.fly({0.5, 0.0, 0.0});
  EXPECT_TRUE(drone.judge.passed());
}

TEST_P(AnyPose, LeftRightAboveAndBelowAreMissed) {
  for (const Eigen::Vector3d& side : {Eigen::Vector3d(0, 0.21, 0), Eigen::Vector3d(0, -0.4, 0),
                                      Eigen::Vector3d(0, 0, 0.21), Eigen::Vector3d(0, 0.1, -0.8)}) {
    Puppet drone = puppet();
    drone.fly(side - Eigen::Vector3d(0.5, 0, 0));
    EXPECT_EQ(drone.fly(side + Eigen::Vector3d(0.5, 0, 0)), Events{Kind::missed});
    EXPECT_TRUE(drone.judge.missed());
    EXPECT_TRUE(drone.judge.reached());
    EXPECT_FALSE(drone.judge.crossed() || drone.judge.passed());
  }
}

TEST_P(AnyPose, FromBehindIsNeitherCrossedNorPassed) {
  Puppet drone = puppet();
  drone.fly({-0.5, 1.0, 0.0});
  EXPECT_EQ(drone.fly({0.5, 1.0, 0.0}), Events{Kind::missed});
  drone.fly({0.5, 0.0, 0.0});
  EXPECT_EQ(drone.fly({-0.5, 0.0, 0.0}), Events{}) << "through the opening, but the wrong way";
  EXPECT_FALSE(drone.judge.crossed() || drone.judge.turned_back() || drone.judge.passed());
  EXPECT_EQ(drone.fly({0.5, 0.0, 0.0}), Events{Kind::crossed}) << "a missed gate may still be passed";
  EXPECT_TRUE(drone.judge.passed());
}

TEST_P(AnyPose, HasNoLateralErrorBeforeTheGateIsReached) {
  Puppet drone = puppet();
  drone.fly({-0.1, 0.1, 0.0});
  EXPECT_FALSE(drone.judge.reached());
  EXPECT_NEAR(drone.judge.distance_m(drone.at.p_WB_m), 0.1, 1e-9);
}

TEST_P(AnyPose, PassedBeginsWhenTheLastCornerIsBehindTheFrame) {
  Puppet drone = puppet();
  const Eigen::Matrix3d R_BG = drone.at.rotation().transpose() * gate();
  // Finds the rearmost of all eight corners.
  double reach_m = 0.0;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d corner_B{(i & 1 ? 0.5 : -0.5) * kBody_m.x(), (i & 2 ? 0.5 : -0.5) * kBody_m.y(),
                                   (i & 4 ? 0.5 : -0.5) * kBody_m.z()};
    reach_m = std::max(reach_m, R_BG.col(0).dot(corner_B));
  }
  drone.fly({reach_m + 0.015 - 1e-6, 0.0, 0.0});
  EXPECT_FALSE(drone.judge.passed());
  drone.fly({reach_m + 0.015 + 1e-6, 0.0, 0.0});
  EXPECT_TRUE(drone.judge.passed());
}

RigidState state_at(double x, double y, double z) {
  RigidState state;
  state.p_WB_m = {x, y, z};
  return state;
}

TEST(GateJudge, OpeningEndsAtItsEdgeToATenthOfAMillimetre) {
  const auto crossing = [](double y, double z) {
    GateJudge judge({gate_at(2.0)}, kBody_m);
    return judge.move(state_at(1.9, y, z), state_at(2.1, y, z))->kind;
  };
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(crossing(sign * 0.1999, 1.0), Kind::crossed);
    EXPECT_EQ(crossing(sign * 0.2001, 1.0), Kind::missed);
    EXPECT_EQ(crossing(0.0, 1.0 + sign * 0.2001), Kind::missed);
  }
}

TEST(GateJudge, JudgesThePointOnThePlaneNotTheEndOfTheMove) {
  GateJudge judge({gate_at(2.0)}, kBody_m);
  // At the plane, y is 0.1. At the end, y is 0.5.
  EXPECT_EQ(judge.move(state_at(1.9, 0.0, 1.0), state_at(2.4, 0.5, 1.0))->kind, Kind::crossed);
  EXPECT_NEAR(judge.lateral_error_m(), 0.1, 1e-12);
}

TEST(GateJudge, LateralErrorIsToTheLeftAsFlown) {
  scene::Gate gate;
  gate.p_W_m = {2.0, 0.0, 1.0};
  gate.yaw_rad = -0.5 * M_PI;  // flown along world -y: left is world +x
  GateJudge judge({GateFrame(gate)}, kBody_m);
  const auto crossing = judge.move(state_at(2.05, 0.1, 1.0), state_at(2.05, -0.1, 1.0));
  ASSERT_TRUE(crossing);
  EXPECT_NEAR(crossing->lateral_m, 0.05, 1e-12);
}

TEST(GateJudge, ATouchOfTenSecondsIsStuckAndASkidIsNot) {
  GateJudge skid({gate_at(2.0)}, kBody_m);
  EXPECT_EQ(skid.touch(0, 0)->kind, Kind::touched);
  for (int i = 1; i < 100; ++i) EXPECT_FALSE(skid.touch(0, i * kSecond_ns / 10)) << "one contact";
  EXPECT_TRUE(skid.touched());
  EXPECT_FALSE(skid.stuck()) << "9.9 s";
  EXPECT_EQ(skid.touch(0, 10 * kSecond_ns)->kind, Kind::stuck);
  EXPECT_TRUE(skid.stuck());
  EXPECT_FALSE(skid.touch(0, 11 * kSecond_ns - kSecond_ns / 2)) << "told once";
}

TEST(GateJudge, TouchesWithABreakAreContactsOfTheirOwn) {
  GateJudge judge({gate_at(2.0)}, kBody_m);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(judge.touch(0, i * kSecond_ns)->kind, Kind::touched);
  EXPECT_FALSE(judge.stuck());
}

TEST(GateJudge, LandingOnTheFrameOrInThePlaneIsStuckAndBehindItIsNot) {
  GateJudge on_the_frame({gate_at(2.0)}, kBody_m);
  on_the_frame.touch(0, 5 * kSecond_ns);
  EXPECT_EQ(on_the_frame.land(state_at(1.9, 0.0, 0.8), 5 * kSecond_ns + kSecond_ns / 5)->kind, Kind::stuck);

  GateJudge in_the_plane({gate_at(2.0)}, kBody_m);
  in_the_plane.move(state_at(1.9, 0.0, 1.0), state_at(2.05, 0.0, 1.0));
  EXPECT_EQ(in_the_plane.land(state_at(2.05, 0.0, 0.0145), 9 * kSecond_ns)->kind, Kind::stuck);

  GateJudge behind({gate_at(2.0)}, kBody_m);
  behind.move(state_at(1.9, 0.0, 1.0), state_at(2.1, 0.0, 1.0));
  behind.touch(0, kSecond_ns);
  EXPECT_FALSE(behind.land(state_at(2.1, 0.0, 0.0145), 9 * kSecond_ns)) << "touched long before";
  EXPECT_FALSE(behind.stuck());

  GateJudge before({gate_at(2.0)}, kBody_m);
  EXPECT_FALSE(before.land(state_at(1.0, 0.0, 0.0145), 9 * kSecond_ns));
}

TEST(GateJudge, GatesCountInTheirOrder) {
  GateJudge judge({gate_at(2.0), gate_at(4.0)}, kBody_m);
  EXPECT_FALSE(judge.move(state_at(3.9, 0.0, 1.0), state_at(4.1, 0.0, 1.0)));  // the second gate first: it is not being
                                                                               // judged yet
  EXPECT_TRUE(judge.move(state_at(1.9, 0.0, 1.0), state_at(2.1, 0.0, 1.0)));
  EXPECT_FALSE(judge.crossed());
  EXPECT_FALSE(judge.passed()) << "behind the first of two";
  EXPECT_NEAR(judge.distance_m({2.1, 0.0, 1.0}), 1.9, 1e-12);
  EXPECT_TRUE(judge.move(state_at(3.9, 0.0, 1.0), state_at(4.1, 0.0, 1.0)));
  EXPECT_TRUE(judge.passed());
  EXPECT_NEAR(judge.distance_m({4.5, 0.0, 1.0}), -0.5, 1e-12);
}

TEST(GateJudge, ACourseMayLeadRoundAGateButNotBackThroughIt) {
  // The second gate is next to the first gate. Its direction of flight is opposite.
  const Eigen::Matrix3d back = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  GateFrame second = gate_at(1.0, back);
  second.p_WG_m.y() = 2.0;
  Puppet round({gate_at(2.0), second});
  EXPECT_EQ(round.fly({1.0, 0.0, 0.0}), Events{Kind::crossed});
  round.fly({1.0, 2.0, 0.0});
  EXPECT_EQ(round.fly({-2.0, 2.0, 0.0}), Events{Kind::crossed}) << "past the first gate's plane, through the second";
  EXPECT_EQ(round.fly({-2.0, 0.0, 0.0}), Events{});
  EXPECT_TRUE(round.judge.passed());
  EXPECT_FALSE(round.judge.turned_back());

  Puppet back_through({gate_at(2.0), second});
  back_through.fly({0.1, 0.0, 0.0});
  EXPECT_EQ(back_through.fly({-0.5, 0.0, 0.0}), Events{Kind::turned_back});
  back_through.fly({-0.5, 2.0, 0.0});
  back_through.fly({0.5, 2.0, 0.0});
  back_through.fly({-2.0, 2.0, 0.0});
  EXPECT_FALSE(back_through.judge.crossed()) << "the first gate is to be crossed again before the second counts";
}

TEST(GateJudge, ASceneWithoutGatesIsNeverPassed) {
  GateJudge judge({}, kBody_m);
  EXPECT_FALSE(judge.move(state_at(0.0, 0.0, 0.0), state_at(1.0, 0.0, 0.0)));
  EXPECT_FALSE(judge.land(state_at(1.0, 0.0, 0.0), kSecond_ns));
  EXPECT_FALSE(judge.passed() || judge.crossed());
  EXPECT_EQ(judge.distance_m({0.0, 0.0, 0.0}), 0.0);
}

TEST(GateJudge, ARestoredOneContinuesUnchanged) {
  // The state is saved after the drone has crossed the gate, 9.6 s after the start of a contact. After 10 s of contact
  // the drone is stuck. Then it flies back through the gate.
  const auto second_half = [](GateJudge& judge) {
    const auto stuck = judge.touch(0, 12 * kSecond_ns);
    const auto turned_back = judge.move(state_at(2.01, 0.05, 1.0), state_at(1.9, 0.05, 1.0));
    return stuck && stuck->kind == Kind::stuck && turned_back && judge.turned_back() && !judge.passed() &&
           judge.crossed() && judge.touched() && judge.reached() && !judge.missed() && judge.lateral_error_m() == 0.05;
  };
  GateJudge straight({gate_at(2.0)}, kBody_m);
  straight.move(state_at(1.9, 0.05, 1.0), state_at(2.01, 0.05, 1.0));
  for (int i = 0; i < 25; ++i) straight.touch(0, 2 * kSecond_ns + i * kSecond_ns * 2 / 5);
  GateJudge restored({gate_at(2.0)}, kBody_m);
  state::restore(restored, state::save(straight));
  EXPECT_TRUE(second_half(straight));
  EXPECT_TRUE(second_half(restored));
}

TEST(GateJudge, RefusesAStateOfASceneWithAnotherNumberOfGates) {
  GateJudge two({gate_at(2.0), gate_at(4.0)}, kBody_m);
  GateJudge one({gate_at(2.0)}, kBody_m);
  EXPECT_THROW(state::restore(one, state::save(two)), Error);
}

}  // namespace
}  // namespace mebots::world
