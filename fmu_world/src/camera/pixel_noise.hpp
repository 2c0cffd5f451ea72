// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace mebots::world::camera {

/// Gaussian sensor noise. It depends only on (seed, frame, row, column), and not on the size of the picture or on the
/// order or thread of its computation.
///
/// Each row of a frame has its own SplitMix64 sequence. One 64-bit number gives four pixels 12 bits each. The bits are
/// an index into 4096 equally likely values of the normal distribution (its quantiles at (i + 1/2) / 4096, scaled to
/// unit variance). Mean and variance are exact. The greatest value is 3.7 standard deviations.
class PixelNoise {
 public:
  /// `standard_deviation` is in grey levels, and must be >= 0.
  explicit PixelNoise(double standard_deviation);

  double standard_deviation() const { return standard_deviation_; }
  /// Adds noise to a row of grey levels that starts at column 0. Has no effect if the standard deviation is 0.
  void add(std::span<float> row_grey, std::uint64_t seed, std::uint64_t frame_index, int row) const;

 private:
  double standard_deviation_;
  std::vector<float> samples_;
};

}  // namespace mebots::world::camera
