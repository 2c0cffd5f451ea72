// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board_file.hpp"
#include "elf/elf.hpp"

namespace mebots::soc::tool {

/// Makes the board of a program that names none. It has one RAM from the page of the program's lowest segment, of at
/// least 4 MiB and at least 1 MiB past its highest segment, and no device. Throws Error when that would be more than 2
/// GiB.
BoardDescription board_around(const Elf& program);

}  // namespace mebots::soc::tool
