// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace mebots::world::camera {

/// Gaussian sensor noise that only depends on (seed, frame, row, column): not on the size of the picture, nor on the
/// order or thread of its computation.
///
/// Each row of each frame has its own SplitMix64 sequence. One 64-bit number serves four pixels with 12 bits each.
/// These are indices into 4096 equally likely values of the normal distribution (its quantiles at (i + 1/2) / 4096,
/// scaled to unit variance). Mean and variance are exact, and the tails end at 3.7 standard deviations.
class PixelNoise {
 public:
  /// `standard_deviation` is in grey levels, and must be >= 0.
  explicit PixelNoise(double standard_deviation);

  double standard_deviation() const { return standard_deviation_; }
  /// Adds noise to a row of grey levels from column 0 on. Has no effect for a standard deviation of 0.
  void add(std::span<float> row_grey, std::uint64_t seed, std::uint64_t frame_index, int row) const;

 private:
  double standard_deviation_;
  std::vector<float> samples_;
};

}  // namespace mebots::world::camera
