// SPDX-License-Identifier: Apache-2.0
#include "sink/png_file.hpp"

#include "mebots/assert.hpp"
#include "mebots/error.hpp"
#include "sink/output_file.hpp"

#include <fmt/format.h>
#include <png.h>

#include <string>

namespace mebots::master {

void write_png(const std::filesystem::path& file, std::span<const std::uint8_t> pixels, std::size_t width) {
  MEBOTS_ASSERT(width > 0 && pixels.size() % width == 0);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(pixels.size() / width);
  image.format = PNG_FORMAT_GRAY;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr) == 0) {
    throw Error(ErrorCode::file_unwritable,
                fmt::format("{}: the picture cannot be written: {}", file.string(), image.message));
  }
  bytes.resize(size);
  OutputFile output(file);
  output.append(bytes);
  output.close();
}

}  // namespace mebots::master
