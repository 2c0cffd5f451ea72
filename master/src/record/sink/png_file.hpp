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

/// Pixels of 8-bit grey values, row by row from the top left. All rows are complete.
struct GreyPicture {
  std::vector<std::uint8_t> pixels;
  std::size_t width = 0;
};

/// Returns a PNG file with 8-bit grey pixels. `pixels` must contain at least one row, and complete rows only. Throws
/// Error.
std::string png_of(std::span<const std::uint8_t> pixels, std::size_t width);

/// Writes a PNG file as png_of() returns it. Throws Error with the name of the file.
void write_png(const std::filesystem::path& file, std::span<const std::uint8_t> pixels, std::size_t width);

/// Returns the pixels of a PNG file with 8-bit grey pixels. Empty if the bytes are not such a file, or if it has more
/// than 2^26 pixels.
std::optional<GreyPicture> read_png(std::string_view bytes);

}  // namespace mebots::master
