// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "command_line/command.hpp"

#include <string>

namespace mebots::command_line {

/// The manual page (man(7)) of a program, or of one of its commands. `program` is the program's name, the command's own
/// for the program's page.
std::string manual_page(const Command& command, const std::string& program, const std::string& version);

}  // namespace mebots::command_line
