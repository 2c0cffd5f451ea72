// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"
#include "elf/elf.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace mebots::soc::tool {

/// Makes the board of a program that names none. It has RAM where the program's segments are loaded and where they run,
/// and no device. A RAM begins at the page of its lowest segment, has at least 4 MiB, and ends at least 1 MiB past its
/// highest segment. Segments with more than 64 MiB between them get a RAM each. Throws Error if that would be more than
/// 2 GiB.
BoardDescription board_around(const Elf& program);

/// Returns the file of a board, which is given by its path or by the name of a board that came with this program.
std::filesystem::path board_file(const std::string& asked);

/// The pictures of a folder, its .png and .pgm files in the order of their names, as grey pixels row by row; colours
/// become grey as libpng weighs them. Throws Error, naming the file, for one that cannot be read or is not `width`
/// pixels wide and at least `least_height` high, and for a folder without pictures.
std::vector<std::vector<std::uint8_t>> read_pictures(const std::filesystem::path& folder, std::uint32_t width,
                                                     std::uint32_t least_height);

}  // namespace mebots::soc::tool
