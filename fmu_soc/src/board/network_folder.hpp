// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"

#include <filesystem>
#include <string>
#include <string_view>

namespace mebots::soc {

/// Returns the program in a folder that `mebots deploy` wrote. It is a firmware that contains the folder's network.
/// `firmware` is the name of the firmware that the mission flies. Throws Error if the folder has no program, or if that
/// program replaces another firmware or is for another board. Throws data::Mistakes for a broken network.json.
std::filesystem::path program_with_network(const std::filesystem::path& folder, std::string_view firmware,
                                           const BoardDescription& board);

}  // namespace mebots::soc
