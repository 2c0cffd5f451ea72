// SPDX-License-Identifier: Apache-2.0
#include "noise/counter_noise.hpp"

#include <gtest/gtest.h>
#include <cmath>

namespace mebots::world::noise {
namespace {

TEST(CounterNoise, HasMeanZeroAndDeviationOne) {
  constexpr int kCount = 100'000;
  double sum = 0.0;
  double squares = 0.0;
  double neighbours = 0.0;
  double last = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double x = gaussian(7, Stream::range, static_cast<std::uint64_t>(i));
    sum += x;
    squares += x * x;
    neighbours += x * last;
    last = x;
  }
  // Four standard errors: 1/sqrt(n) for mean and correlation, sqrt(2/n) for the variance.
  const double error = 1.0 / std::sqrt(kCount);
  EXPECT_NEAR(sum / kCount, 0.0, 4.0 * error);
  EXPECT_NEAR(squares / kCount, 1.0, 4.0 * std::sqrt(2.0) * error);
  EXPECT_NEAR(neighbours / kCount, 0.0, 4.0 * error);
}

TEST(CounterNoise, DependsOnSeedStreamAndIndexAlone) {
  EXPECT_EQ(bits(1, Stream::range, 5), bits(1, Stream::range, 5));
  EXPECT_NE(bits(1, Stream::range, 5), bits(2, Stream::range, 5));
  EXPECT_NE(bits(1, Stream::range, 5), bits(1, Stream::camera, 5));
  EXPECT_NE(bits(1, Stream::range, 5), bits(1, Stream::range, 6));
}

}  // namespace
}  // namespace mebots::world::noise
