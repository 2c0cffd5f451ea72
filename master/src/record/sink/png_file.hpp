// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

/// 8-bit grey pixels, row by row from the top left; whole rows.
struct GreyPicture {
  std::vector<std::uint8_t> pixels;
  std::size_t width = 0;
};

/// The bytes of a PNG file of whole rows of 8-bit grey pixels, of one at least. Throws Error.
std::string png_of(std::span<const std::uint8_t> pixels, std::size_t width);

/// The same into a file. Throws Error that names it.
void write_png(const std::filesystem::path& file, std::span<const std::uint8_t> pixels, std::size_t width);

/// The pixels of a PNG file of 8-bit grey pixels; none for bytes that are not such a file, or of more than 2^26 pixels.
std::optional<GreyPicture> read_png(std::string_view bytes);

}  // namespace mebots::master
