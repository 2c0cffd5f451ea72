// SPDX-License-Identifier: Apache-2.0
#include "mebots/png_file.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>
#include <png.h>

#include <fstream>
#include <iterator>
#include <vector>

namespace mebots {
namespace {

constexpr unsigned kLargest = 4096;

/// Frees the memory of libpng's reader on every exit path.
struct PngImage {
  PngImage() { image.version = PNG_IMAGE_VERSION; }
  ~PngImage() { png_image_free(&image); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;

  png_image image{};
};

}  // namespace

GreyPicture decode_png(std::span<const std::uint8_t> bytes, const std::string& name) {
  PngImage reader;
  const auto refuse = [&] {
    throw Error(ErrorCode::invalid_value,
                fmt::format("{}: this cannot be decoded: {}; a PNG file is needed", name, reader.image.message));
  };
  if (png_image_begin_read_from_memory(&reader.image, bytes.data(), bytes.size()) == 0) refuse();
  if (reader.image.width > kLargest || reader.image.height > kLargest) {
    throw Error(ErrorCode::invalid_value, fmt::format("{}: {} x {} pixels; at most {} x {} are allowed", name,
                                                      reader.image.width, reader.image.height, kLargest, kLargest));
  }
  reader.image.format = PNG_FORMAT_GRAY;
  GreyPicture picture;
  picture.width = static_cast<int>(reader.image.width);
  picture.height = static_cast<int>(reader.image.height);
  picture.grey.resize(PNG_IMAGE_SIZE(reader.image));
  const png_color black{0, 0, 0};
  if (png_image_finish_read(&reader.image, &black, picture.grey.data(), 0, nullptr) == 0) refuse();
  return picture;
}

GreyPicture read_png(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) throw Error(ErrorCode::file_unreadable, fmt::format("{}: cannot be read", file.string()));
  return decode_png({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, file.string());
}

}  // namespace mebots
