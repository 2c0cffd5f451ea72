// SPDX-License-Identifier: Apache-2.0
// Tests the traverser with perfect perception, in a closed loop with a simple model of the drone. At the start of a
// flight, the drone's velocity has an error, as if the stabiliser adapted to the wind. A flight fails if the drone
// touches a frame.

#include "app/traverser.h"

#include "plain_drone.hpp"
#include "rendered_world.hpp"
#include "sight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>

namespace mebots::firmware_test {
namespace {

constexpr double kTraverseStep_s = 0.011;
constexpr int kStepsPerLook = 3;
constexpr double kHalfDrone_m = 0.046;
constexpr double kHalfDroneHeight_m = 0.0145;

struct Start {
  BodyPose pose;
  double field_of_view_rad = 0.87;
  double cruise_m_s = 1.0 / 3.6;
  double drift_m_s = 0.0;  ///< initial error of the velocity along the world's y, which decays within seconds
  double sight_error = 0.0;
};

enum class End { clean, touched, missed, lost };

std::int8_t in_127ths(double value) {
  return static_cast<std::int8_t>(std::lround(127.0 * std::clamp(value, -1.0, 1.0)));
}

/// Returns the output of a network that sees the gate with random errors of at most `start.sight_error`.
sight_t look(const world::scene::Scene& scene, const BodyPose& pose, const Start& start, Uniform& uniform) {
  const world::camera::Intrinsics intrinsics{320, 320, start.field_of_view_rad};
  const auto camera = world::camera::camera_pose({}, pose.p_WB_m, rotation(pose));
  const auto sight = training::sight_of(scene, intrinsics, camera);
  if (sight.visibility != training::Visibility::enough) return {0, 0, 0, -127};
  const auto err = [&] { return uniform(-start.sight_error, start.sight_error); };
  return {in_127ths(sight.yaw + err()), in_127ths(sight.rise + err()), in_127ths(sight.size / SIGHT_MOST_SIZE + err()),
          127};
}

End judge(const world::scene::Gate& gate, const BodyPose& pose) {
  const double across = std::abs(pose.p_WB_m.y() - gate.p_W_m.y());
  const double up = std::abs(pose.p_WB_m.z() - gate.p_W_m.z());
  const double angle = std::remainder(pose.yaw_rad - gate.yaw_rad, 2.0 * M_PI);
  // `half` is half the width that the rotated body needs between the beams: one of its corners enters the space between
  // them first.
  const double half =
      kHalfDrone_m * (std::cos(angle) + std::abs(std::sin(angle))) + 0.5 * gate.thickness_m * std::abs(std::tan(angle));
  if (across > 0.5 * gate.inner_m || up > 0.5 * gate.inner_m) return End::missed;
  const bool clean = across < 0.5 * gate.inner_m - half && up < 0.5 * gate.inner_m - kHalfDroneHeight_m;
  return clean ? End::clean : End::touched;
}

/// Flies to the plane of the last gate. All gates are passed in order, in the direction of x.
End fly(const world::scene::Scene& scene, const Start& start, std::uint64_t seed) {
  const auto micro = [](double value) { return static_cast<std::int32_t>(std::lround(value * 1e6)); };
  auto gate = scene.gates.begin();
  Uniform uniform(seed);
  PlainDrone drone{start.pose};
  policy_t policy;
  policy_init(&policy, true, micro(start.cruise_m_s), micro(start.cruise_m_s));
  traverser_t traverser;
  traverser_init(&traverser, &policy, 800000, 1000000, micro(start.pose.yaw_rad), static_cast<int>(scene.gates.size()));
  traverser_command_t command{0, 0, 1000000};
  traverser_command_t next = command;
  double drift_m_s = start.drift_m_s;
  for (int step = 0; step < 12000; ++step) {
    if (step % kStepsPerLook == 0) {
      // Set-points take effect with a delay of one picture.
      command = next;
      const auto sight = look(scene, drone.pose, start, uniform);
      const traverser_state_t state{micro(drone.velocity_m_s), micro(drone.pose.p_WB_m.z()),
                                    micro(kTraverseStep_s * kStepsPerLook),
                                    micro(std::remainder(drone.pose.yaw_rad, 2.0 * M_PI))};
      next = traverser_step(&traverser, &sight, &state);
    }
    const double before_m = drone.pose.p_WB_m.x();
    drone.move(kTraverseStep_s, command.velocity_um_s * 1e-6, command.yaw_rate_urad_s * 1e-6);
    drone.pose.p_WB_m.y() += drift_m_s * kTraverseStep_s;
    drift_m_s -= drift_m_s * kTraverseStep_s / 2.5;
    const double climb = std::clamp(1.2 * (command.altitude_um * 1e-6 - drone.pose.p_WB_m.z()), -0.3, 0.5);
    drone.pose.p_WB_m.z() += climb * kTraverseStep_s;
    if (before_m < gate->p_W_m.x() && drone.pose.p_WB_m.x() >= gate->p_W_m.x()) {
      const auto end = judge(*gate, drone.pose);
      if (end != End::clean || ++gate == scene.gates.end()) return end;
    }
  }
  return End::lost;
}

/// Returns how many of 200 flights passed without touching a frame, and prints the number of flights with each outcome.
int clean_of_200(const char* what, const world::scene::Scene& scene, const std::function<Start(Uniform&)>& draw) {
  constexpr int kFlights = 200;
  std::array<int, 4> ends{};
  Uniform uniform(2026);
  for (int i = 0; i < kFlights; ++i) {
    const auto start = draw(uniform);
    ++ends[static_cast<std::size_t>(fly(scene, start, 100 + static_cast<std::uint64_t>(i)))];
  }
  std::printf("[ measured ] %s: %d clean, %d touched, %d missed, %d lost\n", what, ends[0], ends[1], ends[2], ends[3]);
  return ends[0];
}

Start near_start(Uniform& uniform, double forwards_m, double sideways_m, double turned_rad) {
  Start start;
  start.pose.p_WB_m = {uniform(-forwards_m, forwards_m), uniform(-sideways_m, sideways_m), 1.0};
  start.pose.yaw_rad = uniform(-turned_rad, turned_rad);
  return start;
}

TEST(Traverser, FliesThroughTheGateAtTheEdgeOfTheView) {
  const auto scene = load_scene("gate_edge");
  EXPECT_GE(clean_of_200("hard", scene, [](Uniform& u) { return near_start(u, 0.3, 0.1, 0.02); }), 196);
}

TEST(Traverser, FliesThroughWithEyesThatErr) {
  const auto scene = load_scene("gate_edge");
  EXPECT_GE(clean_of_200("hard, sight wrong by up to 0.08", scene,
                         [](Uniform& u) {
                           auto start = near_start(u, 0.3, 0.1, 0.02);
                           start.sight_error = 0.08;
                           return start;
                         }),
            196);
}

TEST(Traverser, FliesThroughWhileTheWindCarriesIt) {
  const auto scene = load_scene("gate_edge");
  EXPECT_GE(clean_of_200("hard, carried sideways at up to 0.2 m/s", scene,
                         [](Uniform& u) {
                           auto start = near_start(u, 0.3, 0.1, 0.02);
                           start.drift_m_s = u(-0.2, 0.2);
                           return start;
                         }),
            190);
}

TEST(Traverser, FliesThroughTheEasyGateWithTheWideLens) {
  const auto scene = load_scene("gate_easy");
  EXPECT_EQ(clean_of_200("easy", scene,
                         [](Uniform& u) {
                           auto start = near_start(u, 0.5, 0.5, 0.3);
                           start.field_of_view_rad = 1.51844;
                           return start;
                         }),
            200);
}

TEST(Traverser, ClimbsAndSinksToAGateAtAnotherHeight) {
  for (const double higher_m : {-0.3, 0.3}) {
    auto scene = load_scene("gate_edge");
    scene.gates[0].p_W_m.z() += higher_m;
    EXPECT_GE(clean_of_200(higher_m > 0 ? "0.3 m higher" : "0.3 m lower", scene,
                           [](Uniform& u) { return near_start(u, 0.3, 0.1, 0.02); }),
              190);
  }
}

TEST(Traverser, FliesThroughTwoGatesOneAfterTheOther) {
  auto scene = load_scene("gate_edge");
  scene.gates.push_back(scene.gates[0]);
  scene.gates[1].p_W_m.x() += 3.5;
  scene.gates[1].p_W_m.y() += 0.3;
  EXPECT_GE(clean_of_200("two gates", scene, [](Uniform& u) { return near_start(u, 0.3, 0.1, 0.02); }), 190);
}

TEST(Traverser, SearchesForAGateThatIsNotInThePicture) {
  const auto scene = load_scene("gate_edge");
  EXPECT_GE(clean_of_200("wide", scene, [](Uniform& u) { return near_start(u, 0.3, 0.5, M_PI); }), 190);
}

constexpr sight_t kNoGate{0, 0, 0, -127};
constexpr sight_t kSameGate{0, 0, 10, 127};

traverser_t new_traverser(int gates = 1) {
  policy_t policy;
  policy_init(&policy, false, 277778, 277778);
  traverser_t traverser;
  traverser_init(&traverser, &policy, 800000, 1000000, 0, gates);
  return traverser;
}

/// Passes equal pictures to the traverser while the drone flies at this velocity, at an altitude of 1 m.
traverser_command_t see(traverser_t& traverser, int pictures, sight_t sight, std::int32_t velocity_um_s = 280000) {
  const traverser_state_t state{velocity_um_s, 1000000, 33000, 0};
  traverser_command_t command{};
  for (int i = 0; i < pictures; ++i) command = traverser_step(&traverser, &sight, &state);
  return command;
}

TEST(Traverser, HoversAndTurnsLeftWithoutAnySighting) {
  auto traverser = new_traverser();
  const auto command = see(traverser, 100, kNoGate);
  EXPECT_EQ(traverser.phase, TRAVERSER_SEARCH);
  EXPECT_EQ(command.velocity_um_s, 0);
  EXPECT_GT(command.yaw_rate_urad_s, 0);
}

TEST(Traverser, GoesWhereFourPicturesInARowShowAGatePlainly) {
  auto traverser = new_traverser();
  see(traverser, 2, {20, 0, 10, 127});
  see(traverser, 12, kNoGate);
  see(traverser, 3, {20, 0, 10, 127});
  EXPECT_EQ(traverser.phase, TRAVERSER_SEARCH);
  see(traverser, 1, {20, 0, 10, 127});
  EXPECT_EQ(traverser.phase, TRAVERSER_APPROACH);
}

TEST(Traverser, NeverGoesWhereAllPicturesAreDoubtful) {
  auto traverser = new_traverser();
  const auto command = see(traverser, 1000, {20, 0, 10, 32});
  EXPECT_EQ(traverser.phase, TRAVERSER_SEARCH);
  EXPECT_GT(command.yaw_rate_urad_s, 0) << "and does not stop before them";
  see(traverser, 11, {20, 0, 10, 64});
  EXPECT_EQ(traverser.phase, TRAVERSER_APPROACH);
}

TEST(Traverser, GoesStraightOnWithoutTheGateForASecondAndThenSearchesOnItsSide) {
  auto traverser = new_traverser();
  see(traverser, 20, {-60, 0, 10, 100});
  const auto blind = see(traverser, 30, kNoGate);
  EXPECT_EQ(traverser.phase, TRAVERSER_APPROACH);
  EXPECT_EQ(blind.yaw_rate_urad_s, 0);
  EXPECT_GT(blind.velocity_um_s, 0);
  const auto search = see(traverser, 10, kNoGate);
  EXPECT_EQ(traverser.phase, TRAVERSER_SEARCH);
  EXPECT_EQ(search.velocity_um_s, 0);
  EXPECT_LT(search.yaw_rate_urad_s, 0);
}

/// Returns a traverser that has seen a gate straight ahead, first in 60 pictures while the drone flew 0.55 m, then in
/// 63 pictures (a little more than 2 s) while the drone did not move, as if it leaned against an object.
traverser_t leaning(std::int8_t size) {
  auto traverser = new_traverser();
  see(traverser, 60, {0, 0, size, 127});
  see(traverser, 60, {0, 0, size, 127}, 0);
  EXPECT_NE(traverser.phase, TRAVERSER_ELSEWHERE) << "2 s";
  see(traverser, 3, {0, 0, size, 127}, 0);
  return traverser;
}

TEST(Traverser, FliesBackFromWhatItLeansAgainstToWhereItSawItFirst) {
  for (const std::int8_t size : {std::int8_t{10}, std::int8_t{100}}) {
    auto traverser = leaning(size);
    ASSERT_EQ(traverser.phase, TRAVERSER_ELSEWHERE);
    const auto back = see(traverser, 50, kSameGate, -280000);
    EXPECT_EQ(traverser.phase, TRAVERSER_ELSEWHERE) << "0.46 m";
    EXPECT_LT(back.velocity_um_s, 0);
    EXPECT_EQ(back.yaw_rate_urad_s, 0);
    const auto search = see(traverser, 12, kSameGate, -280000);
    EXPECT_EQ(traverser.phase, TRAVERSER_SEARCH);
    EXPECT_EQ(search.velocity_um_s, 0);
    EXPECT_NE(search.yaw_rate_urad_s, 0);
  }
}

std::int8_t size_in_127ths(double size) {
  return in_127ths(size / SIGHT_MOST_SIZE);
}

/// The size in a sighting of a frame of 0.6 m at a distance of one metre, with the lenses of gate_easy and gate_hard.
constexpr double kSizeAt1mBy87Degrees = 0.316;
constexpr double kSizeAt1mBy50Degrees = 0.645;

/// Passes pictures to the traverser while the drone approaches a gate straight ahead.
void fly_to(traverser_t& traverser, double size_at_1_m, double from_m, double to_m) {
  for (double left_m = from_m; left_m > to_m; left_m -= 0.00924) {
    see(traverser, 1, {0, 0, size_in_127ths(size_at_1_m / left_m), 127});
  }
}

TEST(Traverser, LeavesWhatDoesNotGrowWhereAGateWouldHaveFilledThePicture) {
  auto wall = new_traverser();
  see(wall, 120, {0, 0, 50, 127});
  see(wall, 8, kNoGate);
  EXPECT_EQ(wall.phase, TRAVERSER_ELSEWHERE) << "1.1 m at a size of 0.79";
  EXPECT_LT(see(wall, 1, kNoGate).velocity_um_s, 0);

  auto gate = new_traverser();
  fly_to(gate, kSizeAt1mBy87Degrees, 1.6, 0.4);
  see(gate, 8, kNoGate);
  EXPECT_EQ(gate.phase, TRAVERSER_THROUGH);
}

TEST(Traverser, EntersAGateWhoseEstimatedSizeFallsBeforeItsFrameIsGone) {
  auto traverser = new_traverser();
  fly_to(traverser, kSizeAt1mBy50Degrees, 2.15, 0.55);
  // These sizes are the network's outputs in a flight in the wind.
  for (const double size : {1.10, 1.12, 1.13, 1.26, 1.21, 1.13, 1.17, 1.06, 1.04, 1.02, 1.17,
                            1.20, 1.09, 0.98, 0.96, 0.90, 0.87, 0.83, 0.82, 0.74, 0.83, 0.71}) {
    see(traverser, 1, {0, 0, size_in_127ths(size), 60});
  }
  EXPECT_EQ(traverser.phase, TRAVERSER_APPROACH);
  see(traverser, 8, {0, 0, size_in_127ths(0.4), -33});
  EXPECT_EQ(traverser.phase, TRAVERSER_THROUGH);
}

TEST(Traverser, LeavesWhatGrowsButComesNearerByLessThanItFlies) {
  auto clutter = new_traverser();
  see(clutter, 60, {0, 0, size_in_127ths(0.8), 127});
  for (int i = 0; i < 60; ++i) see(clutter, 1, {0, 0, size_in_127ths(0.8 + 0.006 * i), 127});
  see(clutter, 8, kNoGate);
  EXPECT_EQ(clutter.phase, TRAVERSER_ELSEWHERE) << "by 44 %, but by 0.24 m of 0.55 m";

  auto large = new_traverser();
  fly_to(large, kSizeAt1mBy50Degrees * 0.72 / 0.6, 2.5, 0.6);
  EXPECT_EQ(large.phase, TRAVERSER_THROUGH) << "a frame of 0.72 m";
}

TEST(Traverser, SearchesAtOnceWhereItWasPushedBack) {
  auto traverser = new_traverser();
  see(traverser, 4, kSameGate, 0);
  ASSERT_EQ(traverser.phase, TRAVERSER_APPROACH);
  const auto search = see(traverser, 64, kSameGate, -10000);
  EXPECT_EQ(traverser.phase, TRAVERSER_SEARCH) << "and does not fly on into it";
  EXPECT_EQ(search.velocity_um_s, 0);
}

TEST(Traverser, EntersOnlyAGateThatItHasApproached) {
  auto traverser = new_traverser();
  see(traverser, 75, {0, 0, 100, 127});
  EXPECT_EQ(traverser.phase, TRAVERSER_APPROACH) << "0.7 m";
}

TEST(Traverser, SwingingOverAMarkIsNoWay) {
  auto traverser = new_traverser();
  see(traverser, 33, {0, 0, 100, 127});
  for (int i = 0; i < 20; ++i) {
    see(traverser, 3, {0, 0, 100, 127}, -280000);
    see(traverser, 3, {0, 0, 100, 127});
  }
  EXPECT_EQ(traverser.phase, TRAVERSER_APPROACH) << "20 times back and forth at 0.3 m";
}

TEST(Traverser, TheHeadingThatLedAgainstSomethingIsThatBeforeItTurnedTheDrone) {
  auto traverser = new_traverser();
  see(traverser, 60, {0, 0, 10, 127});
  const traverser_state_t held{0, 1000000, 33000, 1500000};
  const sight_t gate{0, 0, 10, 127};
  while (traverser.phase == TRAVERSER_APPROACH) traverser_step(&traverser, &gate, &held);
  ASSERT_EQ(traverser.phase, TRAVERSER_ELSEWHERE);
  ASSERT_EQ(traverser.dead_ends, 1);
  EXPECT_EQ(traverser.dead_ends_urad[0], 0);
}

TEST(Traverser, EndsItsWayBackAtAnObstacle) {
  auto traverser = leaning(10);
  see(traverser, 175, kNoGate, 0);
  EXPECT_EQ(traverser.phase, TRAVERSER_ELSEWHERE) << "5.8 s";
  see(traverser, 8, kNoGate, 0);
  EXPECT_EQ(traverser.phase, TRAVERSER_SEARCH);
}

TEST(Traverser, DoesNotFollowASightingThatLedAgainstSomethingButOneElsewhere) {
  auto traverser = leaning(10);
  see(traverser, 62, kNoGate, -280000);
  ASSERT_EQ(traverser.phase, TRAVERSER_SEARCH);
  see(traverser, 100, {0, 0, 10, 127}, 0);
  EXPECT_EQ(traverser.phase, TRAVERSER_SEARCH);
  const traverser_state_t elsewhere{0, 1000000, 33000, 900000};
  const sight_t gate{0, 0, 10, 127};
  for (int i = 0; i < 4; ++i) traverser_step(&traverser, &gate, &elsewhere);
  EXPECT_EQ(traverser.phase, TRAVERSER_APPROACH);
}

/// Turns by `by_urad` in steps of 0.0132 rad, with one picture of `sight` per step, and then hovers. The heading wraps
/// around.
traverser_command_t turn(traverser_t& traverser, std::int32_t by_urad, sight_t sight = kNoGate) {
  traverser_command_t command{};
  for (std::int32_t done = 0; done < by_urad; done += 13200) {
    const double yaw_rad = std::remainder(1e-6 * (traverser.yaw_urad + 13200), 2.0 * M_PI);
    const traverser_state_t state{0, 1000000, 33000, static_cast<std::int32_t>(std::lround(yaw_rad * 1e6))};
    command = traverser_step(&traverser, &sight, &state);
    if (traverser.phase != TRAVERSER_SEARCH) break;
  }
  return command;
}

TEST(Traverser, SearchesAMetreFartherOnAfterAWholeTurn) {
  auto traverser = new_traverser();
  see(traverser, 1000, kNoGate, 0);
  EXPECT_EQ(traverser.phase, TRAVERSER_SEARCH) << "it did not turn";
  turn(traverser, 6250000);
  EXPECT_EQ(traverser.phase, TRAVERSER_SEARCH);
  const auto on = turn(traverser, 100000);
  EXPECT_EQ(traverser.phase, TRAVERSER_ELSEWHERE);
  EXPECT_GT(on.velocity_um_s, 0);
  see(traverser, 112, kNoGate);
  EXPECT_EQ(traverser.phase, TRAVERSER_SEARCH);
}

TEST(Traverser, GoesFartherOnWhereThatIsNoDeadEnd) {
  auto traverser = leaning(10);
  see(traverser, 62, kNoGate, -280000);
  turn(traverser, 6700000);
  EXPECT_EQ(traverser.phase, TRAVERSER_SEARCH) << "0.42 rad beside what it leaned against";
  turn(traverser, 200000);
  ASSERT_EQ(traverser.phase, TRAVERSER_ELSEWHERE);
  see(traverser, 62, kNoGate, 0);
  EXPECT_EQ(traverser.phase, TRAVERSER_SEARCH) << "it leaned against something there, too";
  see(traverser, 100, kSameGate, 0);
  EXPECT_EQ(traverser.phase, TRAVERSER_SEARCH) << "and does not go there again";
}

TEST(Traverser, FliesBackFromWhatHoldsItAnywhereOnItsWayThrough) {
  auto traverser = new_traverser();
  see(traverser, 90, {0, 0, 40, 100});
  see(traverser, 20, {0, 0, 100, 100});
  ASSERT_EQ(traverser.phase, TRAVERSER_THROUGH);
  while (traverser.left_um > 100000) see(traverser, 1, kNoGate);
  see(traverser, 62, kNoGate, 0);
  EXPECT_EQ(traverser.phase, TRAVERSER_ELSEWHERE);
}

TEST(Traverser, SearchesTheNextGateAheadWhereTheMissionHasTwo) {
  auto traverser = new_traverser(2);
  const auto fly_through = [&] {
    see(traverser, 90, {0, 0, 40, 100});
    see(traverser, 20, {0, 0, 100, 100});
    ASSERT_EQ(traverser.phase, TRAVERSER_THROUGH);
    see(traverser, 150, kNoGate);
  };
  fly_through();
  EXPECT_EQ(traverser.phase, TRAVERSER_SEARCH);
  turn(traverser, 6300000);
  ASSERT_EQ(traverser.phase, TRAVERSER_ELSEWHERE) << "once around, and on";
  see(traverser, 112, kNoGate);
  ASSERT_EQ(traverser.phase, TRAVERSER_SEARCH);
  const traverser_state_t turned_round{0, 1000000, 33000, 3141593};
  const sight_t gate{0, 0, 10, 127};
  for (int i = 0; i < 50; ++i) traverser_step(&traverser, &gate, &turned_round);
  EXPECT_EQ(traverser.phase, TRAVERSER_SEARCH) << "not back through the first";
  fly_through();
  EXPECT_EQ(traverser.phase, TRAVERSER_DONE);
}

TEST(Traverser, OneOrTwoPicturesOfALargeGateDoNotMakeItNear) {
  for (const int outliers : {1, 2}) {
    for (const int pictures_before : {3, 90}) {
      auto traverser = new_traverser();
      see(traverser, pictures_before, kSameGate);
      see(traverser, outliers, {0, 0, 127, 127});
      for (const int pictures_since : {0, 10, 100}) {
        auto then = traverser;
        see(then, pictures_since, kSameGate);
        see(then, 8, kNoGate);
        EXPECT_NE(then.phase, TRAVERSER_THROUGH)
            << outliers << " after " << pictures_before << ", unseen after " << pictures_since;
      }
    }
  }
}

TEST(Traverser, DiscardsTheSizeOfAGateAfterItsDistanceIsFlown) {
  auto traverser = new_traverser();
  fly_to(traverser, kSizeAt1mBy50Degrees, 2.15, 0.7);
  const sight_t next_gate{0, 0, size_in_127ths(0.3), 127};
  see(traverser, 50, next_gate);
  auto before_it = traverser;
  see(before_it, 8, kNoGate);
  EXPECT_EQ(before_it.phase, TRAVERSER_THROUGH) << "0.46 m, where 0.77 m may be left";
  see(traverser, 50, next_gate);
  auto behind_it = traverser;
  see(behind_it, 8, kNoGate);
  EXPECT_EQ(behind_it.phase, TRAVERSER_APPROACH) << "0.92 m";
  fly_to(traverser, kSizeAt1mBy50Degrees, 2.15, 0.45);
  EXPECT_EQ(traverser.phase, TRAVERSER_THROUGH) << "the next gate counts by its own size";
}

TEST(Traverser, EntersAGateWhoseFirstPicturesGaveNoSize) {
  auto traverser = new_traverser();
  see(traverser, 4, {0, 0, -20, 127}, 0);
  ASSERT_EQ(traverser.phase, TRAVERSER_APPROACH);
  fly_to(traverser, kSizeAt1mBy50Degrees, 2.15, 0.45);
  EXPECT_EQ(traverser.phase, TRAVERSER_THROUGH);
}

TEST(Traverser, HoldsHeadingAndAltitudeFromTheFrameToHalfAMetreBehindTheFarthestGate) {
  auto traverser = new_traverser();
  see(traverser, 90, {10, 20, 40, 100});
  const auto altitude_um = traverser.altitude_um;
  EXPECT_GT(altitude_um, 1000000);
  EXPECT_EQ(traverser.phase, TRAVERSER_APPROACH);
  int sightings = 0;
  for (; traverser.phase == TRAVERSER_APPROACH; ++sightings) see(traverser, 1, {0, 0, 100, 100});
  EXPECT_GT(sightings, 1) << "one picture alone made the gate near";
  // With the longest lens, a frame of 0.6 m has a size of 1.2 at a distance of 0.57 m. The drone flies 0.5 m more, with
  // 9.24 mm per picture.
  const auto blind = see(traverser, 110, kNoGate);
  EXPECT_EQ(traverser.phase, TRAVERSER_THROUGH);
  EXPECT_EQ(blind.yaw_rate_urad_s, 0);
  EXPECT_EQ(blind.altitude_um, traverser.altitude_um);
  EXPECT_GT(blind.velocity_um_s, 0);
  EXPECT_EQ(see(traverser, 8, kNoGate).velocity_um_s, 0);
  EXPECT_EQ(traverser.phase, TRAVERSER_DONE);
}

TEST(Traverser, FliesFartherWhereANearGateLeftThePictureSooner) {
  auto traverser = new_traverser();
  see(traverser, 60, {0, 0, 30, 100});
  see(traverser, 40, {0, 0, 50, 100});
  see(traverser, 10, kNoGate);
  ASSERT_EQ(traverser.phase, TRAVERSER_THROUGH);
  see(traverser, 125, kNoGate);
  EXPECT_EQ(traverser.phase, TRAVERSER_THROUGH) << "1.16 m";
  see(traverser, 30, kNoGate);
  EXPECT_EQ(traverser.phase, TRAVERSER_DONE) << "1.44 m";
}

TEST(Traverser, StaysWithinItsAltitudesForAnyInput) {
  auto traverser = new_traverser();
  see(traverser, 500, {0, 127, 1, 100});
  EXPECT_LE(traverser.altitude_um, 1700000);
  see(traverser, 1000, {0, -127, 1, 100});
  EXPECT_GE(traverser.altitude_um, 250000);
}

}  // namespace
}  // namespace mebots::firmware_test
