// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"
#include "elf/elf.hpp"

namespace mebots::soc::tool {

/// Makes the board of a program that names none. It has RAM where the program's segments are loaded and where they run,
/// and no device. A RAM begins at the page of its lowest segment, has at least 4 MiB, and ends at least 1 MiB past its
/// highest segment. Segments with more than 64 MiB between them get a RAM each. Throws Error if that would be more than
/// 2 GiB.
BoardDescription board_around(const Elf& program);

}  // namespace mebots::soc::tool
