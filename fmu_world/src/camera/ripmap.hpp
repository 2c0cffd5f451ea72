// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace mebots::world::camera {

/// A square tile of grey levels that repeats without end, ready for filtered look-up.
///
/// It is halved along u and along v independently (Williams' mip map, taken per axis), so that ground seen
/// at a grazing angle is averaged over its long axis only. One bilinear look-up per pixel neither shimmers nor smears.
///
/// All levels lie in one array of 2S x 2S for a tile of S x S texels. The level whose width is s = S / 2^k
/// starts at column 2S - 2s; rows alike. Each 32-bit word holds a texel and its right, lower and lower right
/// neighbour (from the low byte up), wrapped round, so that a bilinear look-up reads one word.
class Ripmap {
 public:
  /// Grey level 0..255 of the tile at (u, v) in [0, 1).
  using Pattern = std::function<double(double u, double v)>;

  /// `size` is a power of two, 1..4096. The pattern is averaged over `samples` x `samples` points a texel.
  Ripmap(int size, int samples, const Pattern& pattern);

  int size() const { return size_; }
  /// log2 of the array's row length 2S.
  int row_shift() const { return row_shift_; }
  const std::uint32_t* words() const { return words_.data(); }
  /// What it takes of memory.
  std::size_t bytes() const { return words_.size() * sizeof(words_[0]); }
  /// Grey level of a texel: (0, 0) is level 0 in that direction.
  int texel(int level_u, int level_v, int column, int row) const;

 private:
  int size_;
  int row_shift_;
  std::vector<std::uint32_t> words_;
};

}  // namespace mebots::world::camera
