// SPDX-License-Identifier: Apache-2.0
#include "camera/pixel_noise.hpp"

#include "mebots/error.hpp"
#include "noise/counter_noise.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>

namespace mebots::world::camera {
namespace {

constexpr int kSamples = 4096;

/// Returns x with P(X > x) = tail for a standard normal X and 0 < tail < 1/2. Uses Newton's method. The probability is
/// convex in x for x > 0, so the iterates rise from 0 to the root.
double upper_quantile(double tail) {
  constexpr double kInverseSqrt2Pi = 0.39894228040143267794;
  double x = 0.0;
  for (int i = 0; i < 60; ++i) {
    const double excess = 0.5 * std::erfc(x / std::sqrt(2.0)) - tail;
    const double next = x + excess / (kInverseSqrt2Pi * std::exp(-0.5 * x * x));
    if (next == x) break;
    x = next;
  }
  return x;
}

/// The noise table is symmetrical about 0. `upper` contains its positive values in falling order, before they are
/// scaled to unit variance. `square_sum` is the sum of the squares of all values.
struct Quantiles {
  std::array<double, kSamples / 2> upper{};
  double square_sum = 0.0;

  Quantiles() {
    for (int i = 0; i < kSamples / 2; ++i) {
      upper[i] = upper_quantile((i + 0.5) / kSamples);
      square_sum += 2.0 * upper[i] * upper[i];
    }
  }
};

/// The quantiles of all worlds in the process. They are computed when the library is loaded: a library whose memory has
/// not changed since its loading can run the next mission without being loaded again.
const Quantiles kQuantiles;

}  // namespace

PixelNoise::PixelNoise(double standard_deviation) : standard_deviation_(standard_deviation), samples_(kSamples) {
  if (!(standard_deviation >= 0.0) || !std::isfinite(standard_deviation)) {
    throw Error(fmt::format("camera noise: standard deviation {} must be a finite number >= 0", standard_deviation));
  }
  const double scale = standard_deviation / std::sqrt(kQuantiles.square_sum / kSamples);
  for (int i = 0; i < kSamples / 2; ++i) {
    samples_[i] = static_cast<float>(scale * kQuantiles.upper[i]);
    samples_[kSamples - 1 - i] = -samples_[i];
  }
}

void PixelNoise::add(std::span<float> row_grey, std::uint64_t seed, std::uint64_t frame_index, int row) const {
  if (standard_deviation_ == 0.0) return;
  const std::uint64_t key =
      noise::hashed(noise::hashed(noise::hashed(seed) ^ frame_index) + static_cast<std::uint64_t>(row));
  const float* const samples = samples_.data();
  constexpr std::uint64_t kMask = kSamples - 1;
  std::size_t x = 0;
  std::uint64_t state = key;
  for (; x + 4 <= row_grey.size(); x += 4, state += noise::kGolden) {
    const std::uint64_t bits = noise::hashed(state);
    row_grey[x] += samples[bits & kMask];
    row_grey[x + 1] += samples[(bits >> 16) & kMask];
    row_grey[x + 2] += samples[(bits >> 32) & kMask];
    row_grey[x + 3] += samples[(bits >> 48) & kMask];
  }
  for (std::uint64_t bits = noise::hashed(state); x < row_grey.size(); ++x, bits >>= 16)
    row_grey[x] += samples[bits & kMask];
}

}  // namespace mebots::world::camera
