// SPDX-License-Identifier: Apache-2.0
#include "record/sink/png_file.hpp"

#include "base/packed.hpp"
#include "mebots/assert.hpp"
#include "record/sink/output_file.hpp"

#include <libdeflate.h>
#include <png.h>

#include <algorithm>
#include <cstddef>
#include <string>

namespace mebots::master {
namespace {

void append_number(std::string& bytes, std::size_t value) {
  for (const unsigned shift : {24U, 16U, 8U, 0U}) bytes += static_cast<char>(value >> shift & 0xFFU);
}

/// Appends a PNG chunk: length, type, data, and checksum of type and data.
void append_chunk(std::string& file, std::string_view type, std::string_view data) {
  append_number(file, data.size());
  const auto checked = file.size();
  file.append(type).append(data);
  append_number(file, libdeflate_crc32(0, file.data() + checked, file.size() - checked));
}

std::string head(std::size_t width, std::size_t height) {
  std::string bytes;
  append_number(bytes, width);
  append_number(bytes, height);
  return bytes += {8, 0, 0, 0, 0};  // 8 bits per pixel, grey, deflate, one filter per row, not interlaced
}

/// Applies the PNG filter "Sub": each row becomes the filter's number and the differences of neighbouring pixels. The
/// differences compress better than the pixels, because camera pictures contain noise on gradients.
std::string differences(std::span<const std::uint8_t> pixels, std::size_t width) {
  std::string bytes(pixels.size() + pixels.size() / width, '\1');
  auto to = bytes.begin();
  for (; !pixels.empty(); pixels = pixels.subspan(width)) {
    const auto row = pixels.first(width);
    *++to = static_cast<char>(row.front());
    to = std::transform(row.begin() + 1, row.end(), row.begin(), ++to,
                        [](std::uint8_t right, std::uint8_t left) { return static_cast<char>(right - left); });
  }
  return bytes;
}

}  // namespace

/// Does not use libpng, which compresses with zlib and is 15 % slower. At one picture per second, this would take
/// longer than all other recording. Higher compression levels give no smaller files, because noise has no patterns.
std::string png_of(std::span<const std::uint8_t> pixels, std::size_t width) {
  MEBOTS_ASSERT(width > 0 && !pixels.empty() && pixels.size() % width == 0);
  const auto rows = deflated(differences(pixels, width), Packing::fast);
  constexpr std::size_t kFrame = 64;  // upper bound of the file's bytes without pixels
  std::string file;
  file.reserve(rows.size() + kFrame);
  file += "\x89PNG\r\n\x1A\n";
  append_chunk(file, "IHDR", head(width, pixels.size() / width));
  append_chunk(file, "IDAT", rows);
  append_chunk(file, "IEND", {});
  return file;
}

void write_png(const std::filesystem::path& file, std::span<const std::uint8_t> pixels, std::size_t width) {
  write_whole(file, png_of(pixels, width));
}

std::optional<GreyPicture> read_png(std::string_view bytes) {
  constexpr std::size_t kMostPixels = std::size_t{1} << 26;  // rejects damaged files
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) == 0) return std::nullopt;
  std::optional<GreyPicture> picture;
  if (image.format == PNG_FORMAT_GRAY && std::size_t{image.width} * image.height <= kMostPixels) {
    picture.emplace();
    picture->width = image.width;
    picture->pixels.resize(std::size_t{image.width} * image.height);
    if (png_image_finish_read(&image, nullptr, picture->pixels.data(), 0, nullptr) == 0) picture.reset();
  }
  png_image_free(&image);
  return picture;
}

}  // namespace mebots::master
