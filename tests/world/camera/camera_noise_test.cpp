// SPDX-License-Identifier: Apache-2.0
#include "camera_scenes.hpp"

#include "camera/pixel_noise.hpp"
#include "mebots/error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace mebots::world::camera {
namespace {

std::vector<float> noise_row(const PixelNoise& noise, std::size_t width, std::uint64_t seed, std::uint64_t frame,
                             int row) {
  std::vector<float> grey(width, 0.0F);
  noise.add(grey, seed, frame, row);
  return grey;
}

struct Moments {
  double mean = 0.0, variance = 0.0, skewness = 0.0, kurtosis = 0.0;
};

Moments moments(const std::vector<float>& values) {
  Moments m;
  const double n = static_cast<double>(values.size());
  for (const float x : values) m.mean += x / n;
  for (const float x : values) {
    const double d = x - m.mean;
    m.variance += d * d / n;
    m.skewness += d * d * d / n;
    m.kurtosis += d * d * d * d / n;
  }
  m.skewness /= std::pow(m.variance, 1.5);
  m.kurtosis /= m.variance * m.variance;
  return m;
}

std::vector<float> noise_frame(const PixelNoise& noise, int size, std::uint64_t seed, std::uint64_t frame) {
  std::vector<float> all;
  for (int row = 0; row < size; ++row) {
    const std::vector<float> one = noise_row(noise, size, seed, frame, row);
    all.insert(all.end(), one.begin(), one.end());
  }
  return all;
}

double correlation(const std::vector<float>& a, const std::vector<float>& b, double variance) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(a[i]) * b[i];
  return sum / (static_cast<double>(a.size()) * variance);
}

// The bounds are five standard errors for n = 10^6 samples of a normal distribution: mean 1/sqrt(n), variance
// sqrt(2/n), skewness sqrt(6/n), kurtosis sqrt(24/n), correlation 1/sqrt(n).
constexpr int kNoisySize = 1000;
constexpr double kFive = 5.0 / kNoisySize;

TEST(CameraNoise, IsGaussianWithTheStatedDeviation) {
  const PixelNoise noise(2.0);
  const Moments m = moments(noise_frame(noise, kNoisySize, 4, 17));
  EXPECT_NEAR(m.mean / 2.0, 0.0, kFive);
  EXPECT_NEAR(m.variance / 4.0, 1.0, kFive * std::sqrt(2.0));
  EXPECT_NEAR(m.skewness, 0.0, kFive * std::sqrt(6.0));
  // The table ends at 3.7 standard deviations, which reduces the kurtosis of 3 by 0.01.
  EXPECT_NEAR(m.kurtosis, 2.99, 0.01 + kFive * std::sqrt(24.0));
}

TEST(CameraNoise, FollowsTheNormalDistributionFunction) {
  const PixelNoise noise(1.0);
  const std::vector<float> all = noise_frame(noise, kNoisySize, 9, 0);
  for (double x = -3.0; x <= 3.0; x += 0.5) {
    const double below = static_cast<double>(std::count_if(all.begin(), all.end(), [=](float v) { return v < x; }));
    const double expected = 0.5 * std::erfc(-x / std::sqrt(2.0));
    // The bound is five standard errors of the share of samples below x, plus half of 1/4096, because the noise has
    // only 4096 different values.
    const double bound = 5.0 * std::sqrt(expected * (1.0 - expected)) / kNoisySize + 0.5 / 4096;
    EXPECT_NEAR(below / (kNoisySize * static_cast<double>(kNoisySize)), expected, bound) << "below " << x;
  }
}

TEST(CameraNoise, IsUncorrelatedBetweenNeighboursRowsFramesAndSeeds) {
  const PixelNoise noise(1.0);
  const std::vector<float> frame = noise_frame(noise, kNoisySize, 4, 17);
  for (const int shift : {1, 2, 3, 4, 5, 8, kNoisySize, 2 * kNoisySize, 4 * kNoisySize + 4}) {
    std::vector<float> shifted(frame.begin() + shift, frame.end());
    shifted.insert(shifted.end(), frame.begin(), frame.begin() + shift);
    EXPECT_NEAR(correlation(frame, shifted, 1.0), 0.0, kFive) << "shift " << shift;
  }
  EXPECT_NEAR(correlation(frame, noise_frame(noise, kNoisySize, 4, 18), 1.0), 0.0, kFive);
  EXPECT_NEAR(correlation(frame, noise_frame(noise, kNoisySize, 5, 17), 1.0), 0.0, kFive);
  EXPECT_NEAR(correlation(frame, noise_frame(noise, kNoisySize, 17, 4), 1.0), 0.0, kFive);
}

TEST(CameraNoise, DoesNotDependOnTheSizeOfThePicture) {
  const PixelNoise noise(3.0);
  const std::vector<float> wide = noise_row(noise, 323, 1, 2, 3);
  for (const std::size_t width : {8, 9, 10, 11, 322}) {
    const std::vector<float> narrow = noise_row(noise, width, 1, 2, 3);
    EXPECT_TRUE(std::equal(narrow.begin(), narrow.end(), wide.begin())) << "width " << width;
  }
}

TEST(CameraNoise, InPicturesHasTheStatedMeanAndDeviation) {
  scene::Scene scene = testing::dark_scene();
  scene.lighting.background = 120.0;
  const Intrinsics intrinsics{800, 600, 1.0};
  Renderer renderer(scene, intrinsics, 2.0);
  const testing::Picture seen = testing::picture(renderer, testing::pose({0.0, 0.0, 1.0}, 0.0, -1.5), 6, 3);
  const Moments m = moments({seen.pixels.begin(), seen.pixels.end()});
  const double n = 800.0 * 600.0;
  EXPECT_NEAR(m.mean, 120.0, 5.0 * 2.0 / std::sqrt(n));
  // Rounding to whole grey levels adds 1/12.
  EXPECT_NEAR(m.variance, 4.0 + 1.0 / 12.0, 5.0 * 4.0 * std::sqrt(2.0 / n));
}

TEST(CameraNoise, SaturatesAtBlackAndWhite) {
  scene::Scene scene = testing::dark_scene();
  scene.lighting.background = 255.0;
  Renderer renderer(scene, {}, 5.0);
  const testing::Picture seen = testing::picture(renderer, testing::pose({0.0, 0.0, 1.0}));
  int white = 0;
  int black = 0;
  for (int column = 0; column < 320; ++column) {
    for (int row = 0; row < 100; ++row) white += seen.at(column, row) == 255 ? 1 : 0;
    for (int row = 220; row < 320; ++row) black += seen.at(column, row) == 0 ? 1 : 0;
  }
  // P(noise >= -0.5 grey) for a standard deviation of 5. The bounds are five standard errors.
  const double share = 0.5 * std::erfc(-0.1 / std::sqrt(2.0));
  EXPECT_NEAR(white / 32000.0, share, 5.0 * 0.5 / std::sqrt(32000.0));
  EXPECT_NEAR(black / 32000.0, share, 5.0 * 0.5 / std::sqrt(32000.0));
}

TEST(CameraNoise, KeepsTheExactPictureIfItIsZero) {
  Renderer quiet(testing::patterned_room(), {}, 0.0);
  Renderer noisy(testing::patterned_room(), {}, 2.0);
  const Pose from = testing::pose({0.0, 0.0, 1.0});
  const testing::Picture exact = testing::picture(quiet, from, 1, 0);
  EXPECT_EQ(testing::picture(quiet, from, 2, 5), exact);
  const testing::Picture seen = testing::picture(noisy, from, 2, 5);
  for (std::size_t i = 0; i < seen.pixels.size(); ++i) {
    ASSERT_NEAR(seen.pixels[i], exact.pixels[i], 2.0 * 3.8 + 1.0);  // the table's tails end at 3.7 deviations
  }
}

TEST(CameraNoise, IsAnotherInEachFrame) {
  const PixelNoise noise(2.0);
  std::set<std::vector<float>> rows;
  for (std::uint64_t frame = 0; frame < 100; ++frame) rows.insert(noise_row(noise, 320, 1, frame, 0));
  EXPECT_EQ(rows.size(), 100U);
}

TEST(CameraNoise, RefusesADeviationThatIsNoNumberOrNegative) {
  EXPECT_THROW(PixelNoise(-1.0), Error);
  EXPECT_THROW(PixelNoise(std::nan("")), Error);
}

}  // namespace
}  // namespace mebots::world::camera
