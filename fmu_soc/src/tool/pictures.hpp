// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace mebots::soc::tool {

/// The pictures of a folder, its .png and .pgm files in the order of their names, as grey pixels row by row; colours
/// become grey as libpng weighs them. Throws Error, naming the file, for one that cannot be read or is not `width`
/// pixels wide and at least `least_height` high, and for a folder without pictures.
std::vector<std::vector<std::uint8_t>> read_pictures(const std::filesystem::path& folder, std::uint32_t width,
                                                     std::uint32_t least_height);

}  // namespace mebots::soc::tool
