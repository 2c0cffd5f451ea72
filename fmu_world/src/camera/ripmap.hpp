// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace mebots::world::camera {

/// A square tile of grey levels that repeats without end, for filtered look-ups.
///
/// Stores the tile at all combinations of halved widths and halved heights (Williams' mip map for each axis
/// separately). Therefore a surface that is seen at a grazing angle is averaged only along its long axis. One bilinear
/// look-up per pixel avoids flicker and blur.
///
/// All levels are in one array of 2S x 2S words for a tile of S x S texels. The level with width s = S / 2^k starts at
/// column 2S - 2s, and the level with height s starts at row 2S - 2s. Each 32-bit word contains a texel and its right,
/// lower and lower right neighbours (from the low byte up, with wrap-around), so that a bilinear look-up reads one
/// word.
class Ripmap {
 public:
  /// Returns the grey level 0..255 of the tile at (u, v) in [0, 1).
  using Pattern = std::function<double(double u, double v)>;

  /// `size` must be a power of two from 1 to 4096. Averages the pattern over `samples` x `samples` points per texel.
  Ripmap(int size, int samples, const Pattern& pattern);

  int size() const { return size_; }
  /// Returns log2 of the number of words in a row of words().
  int row_shift() const { return row_shift_; }
  const std::uint32_t* words() const { return words_.data(); }
  /// Returns the size of the texture in memory, in bytes.
  std::size_t bytes() const { return words_.size() * sizeof(words_[0]); }
  /// Returns the grey level of a texel. In each direction, level 0 has the full resolution.
  int texel(int level_u, int level_v, int column, int row) const;

 private:
  int size_;
  int row_shift_;
  std::vector<std::uint32_t> words_;
};

}  // namespace mebots::world::camera
