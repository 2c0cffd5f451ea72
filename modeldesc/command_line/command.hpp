// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): that of CLI11
class App;
}

namespace mebots::command_line {

/// One option or positional argument.
struct Argument {
  std::vector<std::string> names;    ///< "-h", "--help"; of a positional its one name without dashes
  std::string text;                  ///< what the help says
  std::string value;                 ///< "TEXT", "FLOAT ..."; empty for a flag
  std::vector<std::string> choices;  ///< the values that it takes, where they are a list
  bool required = false;
};

/// A program, or one of its commands.
struct Command {
  std::string name;  ///< "mebots", or "run"
  std::string text;
  std::string footer;  ///< sections as help_footer() writes them: "Examples:", then indented lines
  std::vector<Argument> options;
  std::vector<Argument> positionals;
  std::vector<Command> commands;
};

/// Describes the commands and options of the parser.
Command command_of(const CLI::App& app);

// Scripts that complete a program's commands, options and values; file names elsewhere.
std::string bash_completion(const Command& program);
std::string fish_completion(const Command& program);
std::string zsh_completion(const Command& program);

/// The manual page (man(7)) of a program, or of one of its commands. `program` is the program's name, the command's own
/// for the program's page.
std::string manual_page(const Command& command, const std::string& program, const std::string& version);

}  // namespace mebots::command_line

namespace CLI {  // NOLINT(readability-identifier-naming): that of CLI11
class App;
}

namespace mebots::command_line {

/// Two command lines that --help does not list, for packages rather than for people: `PROGRAM --print-completion
/// bash|fish|zsh` prints what the shell needs to complete the program's command line, `PROGRAM --write-manuals FOLDER`
/// writes a manual page for the program and one for each of its commands. Returns the exit code when the command line
/// was one of these. `app` has its name and all its commands; `version` stands on the pages.
std::optional<int> handle_hidden_options(const CLI::App& app, const std::string& version, int argument_count,
                                         const char* const* arguments);

}  // namespace mebots::command_line
