// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board_file.hpp"
#include "elf/elf.hpp"

namespace mebots::soc::tool {

/// The board of a program that names none. One RAM from the page of the program's lowest segment, at least 4 MiB and
/// at least 1 MiB past its highest segment, no device. Throws Error when that would be more than 2 GiB.
BoardDescription board_around(const Elf& program);

}  // namespace mebots::soc::tool
