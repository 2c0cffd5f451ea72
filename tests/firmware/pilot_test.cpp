// SPDX-License-Identifier: Apache-2.0
// Tests the pilot alone, with synthetic outputs of the navigator.

#include "app/pilot.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace mebots::firmware_test {
namespace {

constexpr std::int32_t kCruise = 277778;       // um/s
constexpr std::int32_t kYawScale = 500000;     // urad/s
constexpr std::int32_t kFramePeriod = 100000;  // us
constexpr navigator_output_t kNothing{0, 0, 0};

pilot_t new_pilot(bool adaptive = false) {
  pilot_t pilot;
  policy_t policy;
  policy_init(&policy, adaptive, kCruise, kCruise);
  pilot_init(&pilot, &policy, kYawScale);
  return pilot;
}

/// Passes the same output of the navigator to the pilot for some pictures, while the drone flies at this velocity.
/// Returns the last command.
pilot_command_t see(pilot_t& pilot, int pictures, navigator_output_t seen, std::int32_t velocity_um_s = 0) {
  pilot_command_t command{};
  for (int i = 0; i < pictures; ++i) command = pilot_step(&pilot, &seen, velocity_um_s, kFramePeriod);
  return command;
}

TEST(Pilot, HoversAndTurnsLeftIfNoGateWasSeen) {
  auto pilot = new_pilot();
  const auto command = see(pilot, 50, kNothing);
  EXPECT_EQ(pilot.phase, PILOT_SEARCH);
  EXPECT_EQ(command.velocity_um_s, 0);
  EXPECT_GT(command.yaw_rate_urad_s, 0);
}

TEST(Pilot, FliesOnlyAfterThreeSightingsInARow) {
  auto pilot = new_pilot();
  EXPECT_EQ(see(pilot, 2, {10, 200, 4000}).velocity_um_s, 0);
  see(pilot, 1, kNothing);
  EXPECT_EQ(see(pilot, 2, {10, 200, 4000}).velocity_um_s, 0);
  EXPECT_EQ(see(pilot, 1, {10, 200, 4000}).velocity_um_s, kCruise);
  EXPECT_EQ(pilot.phase, PILOT_APPROACH);
}

TEST(Pilot, IgnoresSightingsOfLittleConfidence) {
  auto pilot = new_pilot();
  EXPECT_EQ(see(pilot, 20, {10, 30, 4000}).velocity_um_s, 0);
  EXPECT_EQ(pilot.phase, PILOT_SEARCH);
}

TEST(Pilot, TurnsTowardsTheGateInProportionToTheNavigatorsOutput) {
  auto pilot = new_pilot();
  EXPECT_EQ(see(pilot, 5, {127, 255, 4000}).yaw_rate_urad_s, kYawScale);
  EXPECT_EQ(see(pilot, 1, {-127, 255, 4000}).yaw_rate_urad_s, -kYawScale);
  EXPECT_NEAR(see(pilot, 1, {-32, 255, 4000}).yaw_rate_urad_s, -kYawScale * 32 / 127, 1);
}

TEST(Pilot, CarriesTheDistanceOnByTheVelocityWhileTheGateIsOutOfSight) {
  auto pilot = new_pilot();
  see(pilot, 5, {0, 255, 4000});
  ASSERT_EQ(pilot.remaining_um, 4000000);
  see(pilot, 1, kNothing, kCruise);  // from rest: half a period at cruise speed
  EXPECT_NEAR(pilot.remaining_um, 4000000 - kCruise / 20, 1);
  see(pilot, 9, kNothing, kCruise);
  EXPECT_NEAR(pilot.remaining_um, 4000000 - kCruise / 20 - 9 * kCruise / 10, 10);
}

TEST(Pilot, OneWildDistanceDoesNotMoveTheEstimate) {
  auto pilot = new_pilot();
  see(pilot, 5, {0, 255, 4000});
  see(pilot, 1, {0, 255, 900});
  EXPECT_EQ(pilot.remaining_um, 4000000);
  EXPECT_EQ(pilot.phase, PILOT_APPROACH);
}

TEST(Pilot, BelievesADistanceThatFivePicturesAgreeOn) {
  auto pilot = new_pilot();
  see(pilot, 5, {0, 255, 4000});
  see(pilot, 5, {0, 255, 2000});
  EXPECT_EQ(pilot.remaining_um, 2000000);
}

TEST(Pilot, SearchesTowardsTheSideWhereAFarGateWasLost) {
  auto pilot = new_pilot();
  see(pilot, 5, {-60, 255, 4000});
  const auto straight = see(pilot, 10, kNothing);
  EXPECT_EQ(straight.velocity_um_s, kCruise);
  EXPECT_EQ(straight.yaw_rate_urad_s, 0);
  const auto search = see(pilot, 10, kNothing);
  EXPECT_EQ(pilot.phase, PILOT_SEARCH);
  EXPECT_EQ(search.velocity_um_s, 0);
  EXPECT_LT(search.yaw_rate_urad_s, 0);
}

TEST(Pilot, FliesStraightThroughAGateThatLeftTheViewAndIsDoneBehindIt) {
  auto pilot = new_pilot();
  see(pilot, 5, {0, 255, 800});
  double flown_m = 0.0;
  while (pilot.phase != PILOT_DONE && flown_m < 5.0) {
    const auto command = see(pilot, 1, kNothing, kCruise);
    flown_m += kCruise * 1e-6 * kFramePeriod * 1e-6;
    if (pilot.phase != PILOT_DONE) {
      ASSERT_EQ(command.velocity_um_s, kCruise);
      ASSERT_EQ(command.yaw_rate_urad_s, 0);
    }
  }
  // The drone stops half a metre beyond the plane. The tolerance covers rounding and the start of the motion. It is the
  // distance flown in one and a half frame periods.
  EXPECT_NEAR(flown_m, 0.8 + 0.5, 0.045);
  EXPECT_EQ(see(pilot, 1, kNothing, kCruise).velocity_um_s, 0);
}

TEST(Pilot, DoesNotTurnForPicturesDuringTheCrossing) {
  auto pilot = new_pilot();
  see(pilot, 5, {0, 255, 400});
  ASSERT_EQ(pilot.phase, PILOT_THROUGH);
  EXPECT_EQ(see(pilot, 1, {120, 255, 3000}, kCruise).yaw_rate_urad_s, 0);
  EXPECT_EQ(pilot.phase, PILOT_THROUGH);
}

TEST(Pilot, AdaptivePolicyFliesThroughTheGateHoweverSlowItCameThere) {
  auto pilot = new_pilot(true);
  see(pilot, 40, {127, 255, 400});
  ASSERT_EQ(pilot.phase, PILOT_THROUGH);
  const auto command = see(pilot, 10, kNothing, 0);
  EXPECT_EQ(command.velocity_um_s, kCruise);
}

}  // namespace
}  // namespace mebots::firmware_test
