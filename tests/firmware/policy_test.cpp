// SPDX-License-Identifier: Apache-2.0
// Tests the speed policies of the paper. The adaptive policy uses the mean of the last ten outputs, a threshold
// of 0.3, and steps of 0.05 km/h. The cruise speed is 1 km/h.

#include "app/policy.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace mebots::firmware_test {
namespace {

constexpr std::int32_t kOneKmPerHour = 277778;   // um/s
constexpr std::int32_t kFiveHundredths = 13889;  // 0.05 km/h in um/s
constexpr std::int8_t kThreeTenths = 38;         // 0.2992 of 127, the largest output that is not above 0.3
constexpr std::int8_t kAboveThreeTenths = 39;

policy_t adaptive() {
  policy_t policy;
  policy_init(&policy, true, kOneKmPerHour, kOneKmPerHour);
  return policy;
}

std::int32_t after(policy_t& policy, int count, std::int8_t yaw) {
  std::int32_t speed = 0;
  for (int i = 0; i < count; ++i) speed = policy_speed_um_s(&policy, yaw);
  return speed;
}

TEST(Policy, ConstantSpeedIsTheCruiseSpeedWhereverTheGateIs) {
  policy_t policy;
  policy_init(&policy, false, 123456, 0);
  for (int yaw = -127; yaw <= 127; ++yaw) {
    ASSERT_EQ(policy_speed_um_s(&policy, static_cast<std::int8_t>(yaw)), 123456);
  }
}

TEST(Policy, AdaptiveSpeedIsTheCruiseSpeedUpToAMeanOfThreeTenthsOnEitherSide) {
  auto policy = adaptive();
  EXPECT_EQ(after(policy, 20, kThreeTenths), kOneKmPerHour);
  EXPECT_EQ(after(policy, 40, -kThreeTenths), kOneKmPerHour);
}

TEST(Policy, AdaptiveSpeedFallsByFiveHundredthsOfAKmPerHourAtEachOutputAboveThreeTenths) {
  auto policy = adaptive();
  for (int i = 1; i <= 10; ++i) {
    ASSERT_EQ(policy_speed_um_s(&policy, kAboveThreeTenths), kOneKmPerHour - i * kFiveHundredths);
  }
}

TEST(Policy, AdaptiveSpeedFallsOnTheRightSideAsOnTheLeft) {
  auto left = adaptive();
  auto right = adaptive();
  EXPECT_EQ(after(left, 7, 100), after(right, 7, -100));
}

TEST(Policy, AdaptiveSpeedNeverFallsBelowZero) {
  auto policy = adaptive();
  for (int i = 0; i < 100; ++i) ASSERT_GE(policy_speed_um_s(&policy, 127), 0);
  EXPECT_EQ(policy_speed_um_s(&policy, 127), 0);
}

TEST(Policy, AdaptiveSpeedReturnsToTheCruiseSpeedAtOnceWhenTheMeanOfTheLastTenFallsToThreeTenths) {
  auto policy = adaptive();
  after(policy, 30, 127);
  // Seven zeros leave three outputs of 1 in the window, so the mean is exactly 0.3.
  EXPECT_EQ(after(policy, 6, 0), 0);
  EXPECT_EQ(policy_speed_um_s(&policy, 0), kOneKmPerHour);
}

TEST(Policy, AdaptiveSpeedForgetsOutputsOlderThanTen) {
  auto policy = adaptive();
  after(policy, 50, 127);
  after(policy, 10, 0);
  // With nine zeros and one output of 127, the mean is 0.1.
  EXPECT_EQ(policy_speed_um_s(&policy, 127), kOneKmPerHour);
}

TEST(Policy, OutputsOnBothSidesOfTheMiddleCancelInTheMean) {
  auto policy = adaptive();
  policy_speed_um_s(&policy, 100);
  for (int i = 0; i < 20; ++i) ASSERT_EQ(policy_speed_um_s(&policy, i % 2 == 0 ? -100 : 100), kOneKmPerHour);
}

}  // namespace
}  // namespace mebots::firmware_test
