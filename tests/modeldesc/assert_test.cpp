// SPDX-License-Identifier: Apache-2.0
// Tests assertions as in the presets dev and ci, in builds of any preset.
#ifndef MEBOTS_ASSERTIONS
#define MEBOTS_ASSERTIONS
#endif
#include "mebots/assert.hpp"

#include <gtest/gtest.h>

#include <string>

namespace mebots::test {

int unchecked_half(int number, int& evaluations);

namespace {

constexpr int kLine = __LINE__ + 2;
int checked_half(int number, int& evaluations) {
  MEBOTS_ASSERT(++evaluations > 0 && number % 2 == 0, "only even numbers");
  MEBOTS_ASSERT(number >= 0);
  return number / 2;
}

TEST(AssertDeathTest, AbortsWithFileLineFunctionConditionAndReason) {
  int evaluations = 0;
  EXPECT_EQ(checked_half(4, evaluations), 2);
  EXPECT_EQ(evaluations, 1);
  EXPECT_EXIT(checked_half(3, evaluations), testing::KilledBySignal(SIGABRT),
              "assert_test.cpp:" + std::to_string(kLine) +
                  ": checked_half: assertion failed: .*number % 2 == 0: only even numbers");
  EXPECT_EXIT(checked_half(-2, evaluations), testing::KilledBySignal(SIGABRT), "assertion failed: number >= 0\n");
}

TEST(AssertDeathTest, DoesNotEvaluateTheConditionWithoutAssertions) {
  int evaluations = 0;
  EXPECT_EQ(unchecked_half(3, evaluations), 1);
  EXPECT_EQ(evaluations, 0);
}

}  // namespace
}  // namespace mebots::test
