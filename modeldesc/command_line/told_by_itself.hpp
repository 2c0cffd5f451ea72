// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): that of CLI11
class App;
}

namespace mebots::command_line {

/// Two command lines that --help does not list, for packages rather than for people: `PROGRAM --print-completion
/// bash|fish|zsh` prints what the shell needs to complete the program's command line, `PROGRAM --write-manuals FOLDER`
/// writes a manual page for the program and one for each of its commands. Returns the exit code when the command line
/// was one of these. `app` has its name and all its commands; `version` stands on the pages.
std::optional<int> tell_of_it(const CLI::App& app, const std::string& version, int argument_count,
                              const char* const* arguments);

}  // namespace mebots::command_line
