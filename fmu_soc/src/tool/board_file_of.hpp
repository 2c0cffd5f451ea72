// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace mebots::soc::tool {

/// The file of a board that is asked for: that path, or, for a name alone that is none, the board of that name that
/// came with this program.
std::filesystem::path board_file(const std::string& asked);

}  // namespace mebots::soc::tool
