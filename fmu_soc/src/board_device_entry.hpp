// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board_file.hpp"

#include "mebots/data/node.hpp"

#include <set>
#include <string>

namespace mebots::soc {

/// A device or part as a board file has it. Complains of what cannot be in it; `names` are those taken on the board.
BoardDevice read_device(const data::Node& node, std::set<std::string>& names);

}  // namespace mebots::soc
