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

/// A picture of 8-bit grey pixels, stored row by row from the top left. All rows are complete.
struct GreyPicture {
  std::vector<std::uint8_t> pixels;
  std::size_t width = 0;
};

/// Encodes 8-bit grey pixels as a PNG file and returns its bytes. `pixels` must contain at least one row, and only
/// complete rows. Throws Error if encoding fails.
std::string png_of(std::span<const std::uint8_t> pixels, std::size_t width);

/// Writes pixels, encoded by png_of(), to a PNG file. Throws Error that names the file if this fails.
void write_png(const std::filesystem::path& file, std::span<const std::uint8_t> pixels, std::size_t width);

/// Decodes a PNG file of 8-bit grey pixels. Returns nullopt if the bytes are not such a file, or if it has more than
/// 2^26 pixels.
std::optional<GreyPicture> read_png(std::string_view bytes);

}  // namespace mebots::master
