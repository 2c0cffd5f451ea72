// SPDX-License-Identifier: Apache-2.0
//
// Tests single precision against IEEE 754-2019: special values, all rounding modes at the limits of the format, and
// random operands, compared with exact arithmetic in double precision.
#include "instructions/float32.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace mebots::soc::float32 {
namespace {

constexpr std::uint32_t kOne = 0x3f800000;
constexpr std::uint32_t kTwo = 0x40000000;
constexpr std::uint32_t kLargest = 0x7f7fffff;
constexpr std::uint32_t kLeastNormal = 0x00800000;
constexpr std::uint32_t kLargestSubnormal = 0x007fffff;
constexpr std::uint32_t kLeast = 1;
constexpr std::uint32_t kSignaling = 0x7f800001;

/// A result and its flags. Outcomes contains one for each rounding mode, in the order of Rounding.
struct Outcome {
  std::uint32_t bits;
  unsigned flags;
  bool operator==(const Outcome&) const = default;
};
using Outcomes = std::array<Outcome, kRoundings>;

void PrintTo(const Outcome& outcome, std::ostream* out) {
  *out << std::hex << outcome.bits << " flags " << outcome.flags;
}

template <typename Compute>
Outcomes all(Compute compute) {
  Outcomes outcomes{};
  for (unsigned mode = 0; mode < kRoundings; ++mode) {
    Context context{static_cast<Rounding>(mode)};
    outcomes[mode].bits = compute(context);
    outcomes[mode].flags = context.flags;
  }
  return outcomes;
}

Outcomes same(std::uint32_t bits, unsigned flags) {
  return {{{bits, flags}, {bits, flags}, {bits, flags}, {bits, flags}, {bits, flags}}};
}

TEST(Float32, RoundsSumsInAllModes) {
  const auto sum = [](std::uint32_t a, std::uint32_t b) { return all([=](Context& c) { return add(a, b, c); }); };
  // 1 + 2^-24 is halfway between 1 and the next number.
  EXPECT_EQ(sum(kOne, 0x33800000), (Outcomes{{{kOne, 1}, {kOne, 1}, {kOne, 1}, {kOne + 1, 1}, {kOne + 1, 1}}}));
  EXPECT_EQ(sum(kOne | kSign, 0xb3800000),
            (Outcomes{{{0xbf800000, 1}, {0xbf800000, 1}, {0xbf800001, 1}, {0xbf800000, 1}, {0xbf800001, 1}}}));
  // Beyond the format, the result is infinity or the largest number.
  const unsigned over = kOverflow | kInexact;
  EXPECT_EQ(sum(kLargest, kLargest),
            (Outcomes{{{kInfinity, over}, {kLargest, over}, {kLargest, over}, {kInfinity, over}, {kInfinity, over}}}));
  // An exact zero is -0 only when rounding down.
  EXPECT_EQ(sum(kOne, kOne | kSign), (Outcomes{{{0, 0}, {0, 0}, {kSign, 0}, {0, 0}, {0, 0}}}));
  EXPECT_EQ(sum(kSign, kSign), same(kSign, 0));
  // Sums of subnormal numbers are exact.
  EXPECT_EQ(sum(kLeast, kLargestSubnormal), same(kLeastNormal, 0));
}

TEST(Float32, DetectsTininessAfterRounding) {
  const auto product = [](std::uint32_t a, std::uint32_t b) {
    return all([=](Context& c) { return multiply(a, b, c); });
  };
  const unsigned under = kUnderflow | kInexact;
  // The exact product is half of the least positive number.
  EXPECT_EQ(product(kLeast, 0x3f000000), (Outcomes{{{0, under}, {0, under}, {0, under}, {1, under}, {1, under}}}));
  // (1 - 2^-24) * 2^-126: rounded to 24 bits, it stays below 2^-126, and so is tiny.
  EXPECT_EQ(product(0x3f7fffff, kLeastNormal), (Outcomes{{{kLeastNormal, under},
                                                          {kLargestSubnormal, under},
                                                          {kLargestSubnormal, under},
                                                          {kLeastNormal, under},
                                                          {kLeastNormal, under}}}));
  // (1 + 2^-23) * (1 - 2^-23) * 2^-126 = (1 - 2^-46) * 2^-126: rounded to 24 bits, it is 2^-126, and not tiny.
  EXPECT_EQ(product(0x1f800001, 0x207ffffe), (Outcomes{{{kLeastNormal, 1},
                                                        {kLargestSubnormal, under},
                                                        {kLargestSubnormal, under},
                                                        {kLeastNormal, 1},
                                                        {kLeastNormal, 1}}}));
  EXPECT_EQ(product(kLeastNormal, 0x3f000000), same(0x00400000, 0)) << "exact, so no underflow";
}

TEST(Float32, ReturnsTheCanonicalNan) {
  const auto nan = [](unsigned flags) { return same(kCanonicalNan, flags); };
  const auto infinity = kInfinity;
  const auto minus = kInfinity | kSign;
  EXPECT_EQ(all([=](Context& c) { return add(0xffc12345, kOne, c); }), nan(0));
  EXPECT_EQ(all([=](Context& c) { return add(kSignaling, kOne, c); }), nan(kInvalid));
  EXPECT_EQ(all([=](Context& c) { return add(infinity, minus, c); }), nan(kInvalid));
  EXPECT_EQ(all([=](Context& c) { return multiply(infinity, 0, c); }), nan(kInvalid));
  EXPECT_EQ(all([=](Context& c) { return divide(0, kSign, c); }), nan(kInvalid));
  EXPECT_EQ(all([=](Context& c) { return divide(infinity, minus, c); }), nan(kInvalid));
  EXPECT_EQ(all([=](Context& c) { return square_root(kOne | kSign, c); }), nan(kInvalid));
  EXPECT_EQ(all([=](Context& c) { return multiply_add(infinity, 0, kCanonicalNan, c); }), nan(kInvalid));
  EXPECT_EQ(all([=](Context& c) { return multiply_add(infinity, kOne, minus, c); }), nan(kInvalid));
  EXPECT_EQ(all([=](Context& c) { return divide(kOne | kSign, 0, c); }), same(minus, kDivideByZero));
  EXPECT_EQ(all([=](Context& c) { return square_root(kSign, c); }), same(kSign, 0));
}

TEST(Float32, RoundsAProductAndSumOnce) {
  // (1 + 2^-23)^2 - (1 + 2^-22) = 2^-46
  Context context;
  EXPECT_EQ(multiply_add(0x3f800001, 0x3f800001, 0xbf800002, context), 0x28800000U);
  EXPECT_EQ(context.flags, 0);
  // If the product is much smaller than the summand, it affects only the rounding.
  EXPECT_EQ(all([](Context& c) { return multiply_add(kLeast, kLeast | kSign, kOne, c); }),
            (Outcomes{{{kOne, 1}, {kOne - 1, 1}, {kOne - 1, 1}, {kOne, 1}, {kOne, 1}}}));
}

TEST(Float32, ConvertsIntegers) {
  const auto to = [](std::uint32_t a) { return all([=](Context& c) { return to_signed(a, c); }); };
  EXPECT_EQ(to(0x40200000), (Outcomes{{{2, 1}, {2, 1}, {2, 1}, {3, 1}, {3, 1}}})) << "2.5";
  EXPECT_EQ(to(0xc0200000), (Outcomes{{{~1U, 1}, {~1U, 1}, {~2U, 1}, {~1U, 1}, {~2U, 1}}})) << "-2.5";
  EXPECT_EQ(to(0xcf000000), same(0x80000000, 0)) << "-2^31";
  EXPECT_EQ(to(0x4f000000), same(0x7fffffff, kInvalid)) << "2^31";
  EXPECT_EQ(to(kCanonicalNan | kSign), same(0x7fffffff, kInvalid));
  EXPECT_EQ(to(kInfinity | kSign), same(0x80000000, kInvalid));
  EXPECT_EQ(to(kLeast), (Outcomes{{{0, 1}, {0, 1}, {0, 1}, {1, 1}, {0, 1}}}));
  const auto to_whole = [](std::uint32_t a) { return all([=](Context& c) { return to_unsigned(a, c); }); };
  EXPECT_EQ(to_whole(0x4f7fffff), same(0xffffff00, 0));
  EXPECT_EQ(to_whole(0x4f800000), same(0xffffffff, kInvalid)) << "2^32";
  EXPECT_EQ(to_whole(0xbf000000), (Outcomes{{{0, 1}, {0, 1}, {0, 16}, {0, 1}, {0, 16}}})) << "-0.5";
  EXPECT_EQ(all([](Context& c) { return from_signed(0x80000000, c); }), same(0xcf000000, 0));
  EXPECT_EQ(all([](Context& c) { return from_unsigned(0xffffffff, c); }),
            (Outcomes{{{0x4f800000, 1}, {0x4f7fffff, 1}, {0x4f7fffff, 1}, {0x4f800000, 1}, {0x4f800000, 1}}}));
}

TEST(Float32, ComparesAndClassifies) {
  Context quiet;
  EXPECT_FALSE(equal(kCanonicalNan, kCanonicalNan, quiet));
  EXPECT_EQ(quiet.flags, 0);
  EXPECT_FALSE(less_or_equal(kCanonicalNan, kOne, quiet));
  EXPECT_EQ(quiet.flags, kInvalid);
  Context none;
  EXPECT_TRUE(equal(0, kSign, none));
  EXPECT_FALSE(less(kSign, 0, none));
  EXPECT_TRUE(less(kTwo | kSign, kOne | kSign, none));
  EXPECT_EQ(minimum(0, kSign, none), kSign);
  EXPECT_EQ(maximum(kSign, 0, none), 0U);
  EXPECT_EQ(minimum(kCanonicalNan, kTwo, none), kTwo);
  EXPECT_EQ(none.flags, 0);
  EXPECT_EQ(maximum(kSignaling, kTwo, none), kTwo);
  EXPECT_EQ(none.flags, kInvalid);
  const std::array values{kInfinity | kSign, kOne | kSign, kLeast | kSign, kSign, 0U, kLeast, kOne,
                          kInfinity,         kSignaling,   kCanonicalNan};
  for (unsigned i = 0; i < values.size(); ++i) EXPECT_EQ(class_of(values[i]), 1U << i);
}

/// A double holds sums and products of these operands exactly, so its conversion to float rounds once.
TEST(Float32, AgreesWithRoundedExactResults) {
  std::mt19937 random(1);  // NOLINT: the same operands each time
  const auto operand = [&] {
    const auto exponent = 115 + random() % 24;
    return (random() & 0x80ffffffU & ~0x7f800000U) | static_cast<std::uint32_t>(exponent << 23);
  };
  const auto value = [](std::uint32_t bits) { return static_cast<double>(std::bit_cast<float>(bits)); };
  const auto nearest = [](double exact) { return std::bit_cast<std::uint32_t>(static_cast<float>(exact)); };
  for (int i = 0; i < 200'000; ++i) {
    const auto a = static_cast<std::uint32_t>(operand());
    const auto b = static_cast<std::uint32_t>(operand());
    Context context;
    const auto sum = value(a) + value(b);
    ASSERT_EQ(add(a, b, context), nearest(sum));
    ASSERT_EQ((context.flags & kInexact) != 0, value(nearest(sum)) != sum);
    const auto product = value(a) * value(b);
    ASSERT_EQ(multiply(a, b, context), nearest(product));
    // The remainder of a quotient or a square root is exact in double precision. Its sign shows whether a result is too
    // large or too small.
    Context down{Rounding::down};
    const auto lower = divide(a, b, down);
    const auto below = value(a) - value(lower) * value(b);
    ASSERT_TRUE(below == 0 || (below < 0) == (value(b) < 0)) << std::hex << a << " " << b;
    Context root_down{Rounding::down};
    const auto positive = a & ~kSign;
    const auto root = value(square_root(positive, root_down));
    ASSERT_LE(root * root, value(positive));
    const auto above = value(nearest(root) + 1);
    ASSERT_GT(above * above, value(positive));
  }
}

}  // namespace
}  // namespace mebots::soc::float32
