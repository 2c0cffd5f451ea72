// SPDX-License-Identifier: Apache-2.0
#include "base/time.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

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

TEST(Time, RefusesTimesOutOfRange) {
  EXPECT_EQ(to_nanoseconds(1e10), std::nullopt);
  EXPECT_EQ(to_nanoseconds(std::numeric_limits<double>::infinity()), std::nullopt);
  EXPECT_EQ(to_nanoseconds(std::numeric_limits<double>::quiet_NaN()), std::nullopt);
}

TEST(Time, EveryMultipleOfADecimalStepComesBackAsTheNearestDouble) {
  // k / 10 is correctly rounded. The seconds of k * 100 ms must be equal.
  for (std::int64_t k = 0; k <= 1'000'000; ++k) {
    ASSERT_EQ(to_seconds(k * 100'000'000), static_cast<double>(k) / 10);
  }
}

TEST(Time, ADecimalMeansTheRatioNextToIt) {
  EXPECT_EQ(exact_time(1.0 / 60), (ExactTime{1, 60}));
  EXPECT_EQ(exact_time(-1.0 / 3), (ExactTime{-1, 3}));
  EXPECT_EQ(exact_time(1000.0 / 60), (ExactTime{50, 3}));
  EXPECT_EQ(exact_time(0.002), (ExactTime{1, 500}));
  EXPECT_EQ(exact_time(1e-9), (ExactTime{1, 1'000'000'000}));
  EXPECT_EQ(exact_time(0.0), (ExactTime{0, 1}));
  EXPECT_EQ(exact_time(0x1p-10), (ExactTime{1, 1024}));
  EXPECT_EQ(exact_time(999'983.0 / 999'979), (ExactTime{999'983, 999'979}));
}

TEST(Time, EveryRatioWithASmallDenominatorIsFoundFromItsDouble) {
  for (std::int64_t q = 1; q <= kLargestDenominator; q += q < 1000 ? 1 : 997) {
    for (const std::int64_t p : {std::int64_t{1}, std::int64_t{7}, q - 1, q + 1, 3 * q + 2}) {
      if (p == 0) continue;
      ASSERT_EQ(exact_time(static_cast<double>(p) / static_cast<double>(q)), reduced(p, q)) << p << "/" << q;
    }
  }
}

TEST(Time, ADecimalFartherFromARatioThanTheToleranceIsRefused) {
  const double sixtieth = 1.0 / 60;
  EXPECT_EQ(exact_time(sixtieth * (1 + 0.9e-15)), (ExactTime{1, 60}));
  EXPECT_EQ(exact_time(sixtieth * (1 + 2e-15)), std::nullopt);
  EXPECT_EQ(exact_time(0.0166666666666), std::nullopt);
  EXPECT_EQ(exact_time(1.0 / 1'000'003), std::nullopt);  // the denominator is a prime above the limit
  EXPECT_EQ(exact_time(1e-8 / 3), std::nullopt);         // the denominator 3e8 is above the limit
  EXPECT_EQ(exact_time(1e10), std::nullopt);
  EXPECT_EQ(exact_time(std::numeric_limits<double>::quiet_NaN()), std::nullopt);
}

TEST(Time, ARatioIsReadFromItsText) {
  EXPECT_EQ(read_ratio("1/60"), (ExactTime{1, 60}));
  EXPECT_EQ(read_ratio("-4/6"), (ExactTime{-2, 3}));
  EXPECT_EQ(read_ratio("1/1000000000"), (ExactTime{1, 1'000'000'000}));
  for (const char* text : {"", "/", "1/", "/3", "1/0", "1/-3", "1 /3", "1/3 ", "+1/3", "1.5/3", "1/3/5", "0.5",
                           "1/10000000000", "99999999999/1", "1/99999999999999999999"}) {
    EXPECT_EQ(read_ratio(text), std::nullopt) << text;
  }
}

TEST(Time, RoundsToWholeNumbersWithTiesToEven) {
  EXPECT_EQ(nearest_whole(1, 2), 0);
  EXPECT_EQ(nearest_whole(3, 2), 2);
  EXPECT_EQ(nearest_whole(5, 2), 2);
  EXPECT_EQ(nearest_whole(-1, 2), 0);
  EXPECT_EQ(nearest_whole(-3, 2), -2);
  EXPECT_EQ(nearest_whole(-5, 2), -2);
  EXPECT_EQ(nearest_whole(7, 3), 2);
  EXPECT_EQ(nearest_whole(8, 3), 3);
  EXPECT_EQ(nearest_whole(-8, 3), -3);
}

/// True if x is the double nearest to numerator / denominator, so that neither neighbour of x is nearer.
bool is_nearest(WideInteger numerator, std::int64_t denominator, double x) {
  // For value = m / 2^s, returns the distance from value to the ratio, times 2^s, times the denominator. This is a
  // whole number.
  const auto distance = [&](double value, int s) {
    const auto m = static_cast<WideInteger>(std::ldexp(value, s));
    const auto difference = (numerator << s) - m * denominator;
    return difference < 0 ? -difference : difference;
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const int s = 54 - std::ilogb(x);  // both neighbours of x are whole numbers at this scale
  return distance(x, s) <= distance(std::nextafter(x, kInfinity), s) &&
         distance(x, s) <= distance(std::nextafter(x, -kInfinity), s);
}

TEST(Time, SecondsOfARatioAreTheNearestDouble) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 200'000; ++i) {
    // Quotients from 2^-10 to 2^33. All products then fit into 128 bits.
    const auto denominator = static_cast<std::int64_t>(random() >> (34 + random() % 29)) + 1;
    const auto numerator = WideInteger{denominator} * static_cast<std::int64_t>(random() >> 31) /
                               static_cast<std::int64_t>(1 + random() % 1000) +
                           static_cast<std::int64_t>(random() % 1000);
    if (numerator == 0) continue;
    const double x = nearest_double(numerator, denominator);
    ASSERT_TRUE(is_nearest(numerator, denominator, x)) << x;
    ASSERT_EQ(nearest_double(-numerator, denominator), -x);
  }
  // Half-way between two doubles, the even one is chosen.
  constexpr std::int64_t kTwoTo53 = std::int64_t{1} << 53;
  EXPECT_EQ(nearest_double(WideInteger{kTwoTo53} + 1, 1), static_cast<double>(kTwoTo53));
  EXPECT_EQ(nearest_double(WideInteger{kTwoTo53} + 3, 1), static_cast<double>(kTwoTo53) + 4);
  EXPECT_EQ(nearest_double(0, 7), 0.0);
}

TEST(Time, SecondsStayNearestBeyondAHundredDays) {
  // No double represents this time exactly.
  EXPECT_EQ(to_seconds(std::int64_t{123'456'789'000'000'003}), 123456789.000000003);
  EXPECT_EQ(to_seconds(std::int64_t{-9'007'199'254'740'993}), -9007199.254740993);
}

}  // namespace
}  // namespace mebots::master
