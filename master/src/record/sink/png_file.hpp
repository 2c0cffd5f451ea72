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

/// Complete rows of 8-bit grey pixels, from the top left.
struct GreyPicture {
  std::vector<std::uint8_t> pixels;
  std::size_t width = 0;
};

/// Encodes 8-bit grey pixels as PNG. `pixels` must contain at least one row, and only complete rows. Throws Error if
/// encoding fails.
std::string png_of(std::span<const std::uint8_t> pixels, std::size_t width);

/// Writes pixels to a PNG file. Throws Error if this fails; the text names the file.
void write_png(const std::filesystem::path& file, std::span<const std::uint8_t> pixels, std::size_t width);

/// Decodes a PNG of 8-bit grey pixels. Returns nullopt if the bytes have another format or more than 2^26 pixels.
std::optional<GreyPicture> read_png(std::string_view bytes);

}  // namespace mebots::master
