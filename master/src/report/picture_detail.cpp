// SPDX-License-Identifier: Apache-2.0
#include "report/run_folder.hpp"

#include "record/sink/png_file.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

namespace mebots::master::report {
namespace {

constexpr std::size_t kLeastWidth = 128;

/// Averages 2 x 2 pixels to one pixel. Drops an odd last row or column.
GreyPicture halved(const GreyPicture& picture) {
  GreyPicture half;
  half.width = picture.width / 2;
  const auto height = picture.pixels.size() / picture.width / 2;
  half.pixels.reserve(half.width * height);
  for (std::size_t row = 0; row < height; ++row) {
    const auto* above = picture.pixels.data() + 2 * row * picture.width;
    const auto* below = above + picture.width;
    for (std::size_t x = 0; x < 2 * half.width; x += 2) {
      const unsigned sum = above[x] + above[x + 1] + below[x] + below[x + 1];
      half.pixels.push_back(static_cast<std::uint8_t>((sum + 2) / 4));
    }
  }
  return half;
}

/// Halves width and height of a picture. Returns false if the result would be too small, or if the file is not a grey
/// PNG.
bool shrink(Picture& picture) {
  const auto read = read_png(picture.png);
  if (!read || read->width / 2 < kLeastWidth || read->pixels.size() / read->width < 2) return false;
  const auto half = halved(*read);
  picture.png = png_of(half.pixels, half.width);
  picture.shrunk *= 2;
  return true;
}

std::size_t bytes_of(const std::vector<Picture*>& pictures) {
  std::size_t bytes = 0;
  for (const auto* picture : pictures) bytes += picture->png.size();
  return bytes;
}

}  // namespace

void fit_into_page(PictureSeries& series, const std::vector<TimeSpan>& whole) {
  const auto stays = [&](const Picture& picture) {
    return std::ranges::any_of(whole, [&](const TimeSpan& span) { return span.holds(picture.time_s); });
  };
  std::vector<Picture*> loose;
  for (auto& picture : series.pictures) {
    if (!stays(picture)) loose.push_back(&picture);
  }
  auto bytes = bytes_of(loose);
  for (bool smaller = true; smaller && bytes > kMostPictureBytes; bytes = bytes_of(loose)) {
    smaller = false;
    for (auto* picture : loose) smaller = shrink(*picture) || smaller;
  }
  series.every = std::max<std::size_t>(1, (bytes + kMostPictureBytes - 1) / kMostPictureBytes);
  if (series.every == 1) return;
  std::size_t number = 0;
  std::erase_if(series.pictures,
                [&](const Picture& picture) { return !stays(picture) && number++ % series.every != 0; });
}

}  // namespace mebots::master::report
