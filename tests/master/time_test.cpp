// SPDX-License-Identifier: Apache-2.0
#include "base/time.hpp"

#include <gmock/gmock.h>

#include <limits>

namespace mebots::master {
namespace {

TEST(Time, DecimalSecondsBecomeWholeNanoseconds) {
  EXPECT_EQ(to_nanoseconds(0.002), 2'000'000);
  EXPECT_EQ(to_nanoseconds(0.1), 100'000'000);
  EXPECT_EQ(to_nanoseconds(1e-9), 1);
  EXPECT_EQ(to_nanoseconds(0.123456789), 123'456'789);
  EXPECT_EQ(to_nanoseconds(100000.000000001), 100'000'000'000'001);
  EXPECT_EQ(to_nanoseconds(0), 0);
  EXPECT_EQ(to_nanoseconds(31'536'000), 31'536'000'000'000'000);
}

TEST(Time, AFractionOfANanosecondIsRefused) {
  EXPECT_EQ(to_nanoseconds(1.5e-9), std::nullopt);
  EXPECT_EQ(to_nanoseconds(1.0001e-9), std::nullopt);
  EXPECT_EQ(to_nanoseconds(0.1000000005), std::nullopt);
  EXPECT_EQ(to_nanoseconds(1.0 / 3.0), std::nullopt);
}

TEST(Time, WhatDoesNotFitIsRefused) {
  EXPECT_EQ(to_nanoseconds(1e10), std::nullopt);
  EXPECT_EQ(to_nanoseconds(std::numeric_limits<double>::infinity()), std::nullopt);
  EXPECT_EQ(to_nanoseconds(std::numeric_limits<double>::quiet_NaN()), std::nullopt);
}

TEST(Time, EveryMultipleOfADecimalStepComesBackAsTheNearestDouble) {
  // k / 10 is correctly rounded, and so must be the seconds of k * 100 ms.
  for (std::int64_t k = 0; k <= 1'000'000; ++k) {
    ASSERT_EQ(to_seconds(k * 100'000'000), static_cast<double>(k) / 10);
  }
}

}  // namespace
}  // namespace mebots::master
