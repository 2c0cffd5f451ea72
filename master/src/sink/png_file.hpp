// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

namespace mebots::master {

/// Writes a picture of 8-bit grey pixels, row by row from the top left, as a PNG file. `pixels` holds whole rows.
/// Throws Error.
void write_png(const std::filesystem::path& file, std::span<const std::uint8_t> pixels, std::size_t width);

}  // namespace mebots::master
