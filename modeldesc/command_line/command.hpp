// SPDX-License-Identifier: Apache-2.0
#pragma once

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

/// What the parser knows.
Command command_of(const CLI::App& app);

}  // namespace mebots::command_line
