// SPDX-License-Identifier: Apache-2.0
#include "camera/ripmap.hpp"

#include "mebots/assert.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstddef>

namespace mebots::world::camera {
namespace {

/// The grey levels of a texture at one of its resolutions, not yet rounded.
struct Level {
  int width;
  int height;
  std::vector<float> grey;

  float& at(int x, int y) { return grey[static_cast<std::size_t>(y) * width + x]; }
  float at(int x, int y) const { return grey[static_cast<std::size_t>(y) * width + x]; }
};

Level sample(int size, int samples, const Ripmap::Pattern& pattern) {
  Level level{size, size, std::vector<float>(static_cast<std::size_t>(size) * size)};
  const double step = 1.0 / (static_cast<double>(size) * samples);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      double sum = 0.0;
      for (int j = 0; j < samples; ++j) {
        for (int i = 0; i < samples; ++i) {
          sum += pattern((x * samples + i + 0.5) * step, (y * samples + j + 0.5) * step);
        }
      }
      level.at(x, y) = static_cast<float>(sum / (static_cast<double>(samples) * samples));
    }
  }
  return level;
}

/// Rounds to the nearest integer, halves upwards. Works as std::lround() for non-negative values without a call.
std::uint8_t rounded(float grey) {
  MEBOTS_ASSERT(grey >= 0.0F && grey <= 255.0F);
  const auto whole = static_cast<int>(grey);
  return static_cast<std::uint8_t>(grey - static_cast<float>(whole) >= 0.5F ? whole + 1 : whole);
}

Level halved_along_u(const Level& fine) {
  MEBOTS_ASSERT(fine.width % 2 == 0);
  Level coarse{fine.width / 2, fine.height, std::vector<float>(fine.grey.size() / 2)};
  for (int y = 0; y < coarse.height; ++y) {
    for (int x = 0; x < coarse.width; ++x) coarse.at(x, y) = 0.5F * (fine.at(2 * x, y) + fine.at(2 * x + 1, y));
  }
  return coarse;
}

Level halved_along_v(const Level& fine) {
  MEBOTS_ASSERT(fine.height % 2 == 0);
  Level coarse{fine.width, fine.height / 2, std::vector<float>(fine.grey.size() / 2)};
  for (int y = 0; y < coarse.height; ++y) {
    for (int x = 0; x < coarse.width; ++x) coarse.at(x, y) = 0.5F * (fine.at(x, 2 * y) + fine.at(x, 2 * y + 1));
  }
  return coarse;
}

}  // namespace

Ripmap::Ripmap(int size, int samples, const Pattern& pattern) : size_(size), row_shift_(0) {
  if (size < 1 || size > 4096 || !std::has_single_bit(static_cast<unsigned>(size))) {
    throw Error(fmt::format("camera texture: size {} is not a power of two in 1..4096", size));
  }
  row_shift_ = std::bit_width(static_cast<unsigned>(size));
  words_.assign(static_cast<std::size_t>(4) * size * size, 0U);

  std::vector<std::uint8_t> greys;
  const auto store = [this, &greys](const Level& level) {
    greys.resize(level.grey.size());
    std::transform(level.grey.begin(), level.grey.end(), greys.begin(), rounded);
    const auto grey = [&](int x, int y) -> std::uint32_t {
      return greys[static_cast<std::size_t>(y) * level.width + x];
    };
    const std::size_t first_column = static_cast<std::size_t>(size_ - level.width) * 2;
    for (int y = 0; y < level.height; ++y) {
      const std::size_t row = static_cast<std::size_t>(2 * size_ - 2 * level.height + y) << row_shift_;
      MEBOTS_ASSERT(row + first_column + level.width <= words_.size());
      const int below = y + 1 == level.height ? 0 : y + 1;
      for (int x = 0; x < level.width; ++x) {
        const int right = x + 1 == level.width ? 0 : x + 1;
        words_[row + first_column + x] =
            grey(x, y) | grey(right, y) << 8 | grey(x, below) << 16 | grey(right, below) << 24;
      }
    }
  };
  for (Level tall = sample(size, samples, pattern);; tall = halved_along_u(tall)) {
    store(tall);
    for (Level level = tall; level.height > 1;) {
      level = halved_along_v(level);
      store(level);
    }
    if (tall.width == 1) break;
  }
}

int Ripmap::texel(int level_u, int level_v, int column, int row) const {
  MEBOTS_ASSERT(level_u >= 0 && level_v >= 0 && size_ >> level_u > 0 && size_ >> level_v > 0,
                "levels end at one texel");
  MEBOTS_ASSERT(column >= 0 && row >= 0);
  const int x = 2 * size_ - 2 * (size_ >> level_u) + column;
  const int y = 2 * size_ - 2 * (size_ >> level_v) + row;
  return static_cast<int>(words_[(static_cast<std::size_t>(y) << row_shift_) + x] & 0xFFU);
}

}  // namespace mebots::world::camera
