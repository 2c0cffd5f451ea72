// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"

#include <filesystem>
#include <string>
#include <string_view>

namespace mebots::soc {

/// Returns the path of the firmware that `mebots deploy` wrote into a folder together with its network. `firmware` is
/// the name of the mission's firmware. Throws Error if the folder has no program, or if that program replaces another
/// firmware or was built for another board. Throws data::Mistakes if network.json has mistakes.
std::filesystem::path program_with_network(const std::filesystem::path& folder, std::string_view firmware,
                                           const BoardDescription& board);

}  // namespace mebots::soc
