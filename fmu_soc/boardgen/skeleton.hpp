// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"

#include <string>

namespace mebots::boardgen {

/// The source of a library of devices with one kind, complete but for what the device does by itself. Registers, states
/// with their energy and delays, opcodes, variables, saving and restoring are there.
std::string skeleton(const soc::BoardDescription& board, const soc::BoardDevice& device);

}  // namespace mebots::boardgen
