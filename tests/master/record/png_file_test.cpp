// SPDX-License-Identifier: Apache-2.0
#include "record/sink/png_file.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace {

using mebots::master::png_of;
using mebots::master::read_png;

TEST(PngFile, LibpngReadsThePixelsThatWereWrittenWhateverTheirNumber) {
  std::mt19937 random(1);
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 5}, {7, 1}, {3, 4}, {320, 320}, {641, 3}}) {
    std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width * height));
    for (auto& pixel : pixels) pixel = static_cast<std::uint8_t>(random());
    const auto back = read_png(png_of(pixels, static_cast<std::size_t>(width)));
    ASSERT_TRUE(back) << width << " x " << height;
    EXPECT_EQ(back->width, static_cast<std::size_t>(width));
    EXPECT_EQ(back->pixels, pixels) << width << " x " << height;
  }
}

TEST(PngFile, AFileWithOneByteChangedIsRefused) {
  const std::vector<std::uint8_t> pixels(64, 9);
  auto bytes = png_of(pixels, 8);
  for (const std::size_t at : {std::size_t{0}, std::size_t{20}, bytes.size() / 2 + 8}) {
    auto damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    EXPECT_FALSE(read_png(damaged)) << at;
  }
}

TEST(PngFile, SlopesWithNoiseTakeFarLessThanAByteEach) {
  constexpr std::size_t kWidth = 320;
  std::mt19937 random(2);
  std::vector<std::uint8_t> pixels(kWidth * kWidth);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    pixels[i] = static_cast<std::uint8_t>(40 + i % kWidth / 2 + random() % 8);
  }
  EXPECT_LT(png_of(pixels, kWidth).size(), pixels.size() * 6 / 10);
}

}  // namespace
