// SPDX-License-Identifier: Apache-2.0

#include "app/work_picture.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <random>
#include <vector>

namespace mebots::firmware_test {
namespace {

std::vector<std::uint8_t> random_picture(int width, int height) {
  std::mt19937 bits(7);
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) * height);
  for (auto& pixel : pixels) pixel = static_cast<std::uint8_t>(bits() & 0xff);
  return pixels;
}

/// Returns the grey level of one pixel of the work picture, from four corners of the integral image.
std::uint32_t pixel(const work_picture_t& work, int x, int y) {
  const int pitch = work.width + 1;
  const auto* at = &work.integral[y * pitch + x];
  return at[pitch + 1] - at[pitch] - at[1] + at[0];
}

TEST(WorkPicture, EveryPixelIsTheRoundedMeanOfItsBlock) {
  for (const int edge : {100, 162, 163, 320, 324, 480, 640}) {
    SCOPED_TRACE(edge);
    const auto pixels = random_picture(edge, edge);
    const auto work = std::make_unique<work_picture_t>();
    ASSERT_TRUE(work_picture_make(work.get(), pixels.data(), edge, edge));
    const int n = work->reduction;
    ASSERT_EQ(work->width, edge / n);
    for (int y = 0; y < work->height; ++y) {
      for (int x = 0; x < work->width; ++x) {
        std::uint32_t sum = 0;
        for (int i = 0; i < n; ++i) {
          for (int j = 0; j < n; ++j) sum += pixels[static_cast<std::size_t>(y * n + i) * edge + x * n + j];
        }
        ASSERT_EQ(pixel(*work, x, y), (sum + n * n / 2) / (n * n)) << x << ' ' << y;
      }
    }
  }
}

TEST(WorkPicture, TakesPicturesThatAreNotSquare) {
  const auto pixels = random_picture(320, 240);
  const auto work = std::make_unique<work_picture_t>();
  ASSERT_TRUE(work_picture_make(work.get(), pixels.data(), 320, 240));
  EXPECT_EQ(work->width, 160);
  EXPECT_EQ(work->height, 120);
}

TEST(WorkPicture, RefusesPicturesTooSmallOrTooLarge) {
  const auto pixels = random_picture(700, 64);
  const auto work = std::make_unique<work_picture_t>();
  EXPECT_FALSE(work_picture_make(work.get(), pixels.data(), 63, 64));
  EXPECT_FALSE(work_picture_make(work.get(), pixels.data(), 64, 63));
  EXPECT_FALSE(work_picture_make(work.get(), pixels.data(), 649, 64));
  EXPECT_TRUE(work_picture_make(work.get(), pixels.data(), 648, 64));
}

}  // namespace
}  // namespace mebots::firmware_test
