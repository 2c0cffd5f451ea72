// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "command_line/command.hpp"

#include <string>

namespace mebots::command_line {

// Scripts that complete a program's commands, options and values; where anything else is asked for, file names.
std::string bash_completion(const Command& program);
std::string fish_completion(const Command& program);
std::string zsh_completion(const Command& program);

}  // namespace mebots::command_line
