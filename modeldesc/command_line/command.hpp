// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): that of CLI11
class App;
}

namespace mebots::command_line {

/// An option or a positional argument.
struct Argument {
  std::vector<std::string> names;    ///< "-h", "--help"; a positional argument has a single name without dashes
  std::string text;                  ///< help text
  std::string value;                 ///< "TEXT", "FLOAT ..."; empty for a flag
  std::vector<std::string> choices;  ///< permitted values, if the argument has a fixed list
  bool required = false;
};

/// A program or a subcommand.
struct Command {
  std::string name;  ///< "mebots", or "run"
  std::string text;
  std::string footer;  ///< sections in the format of help_footer(): "Examples:", then indented lines
  std::vector<Argument> options;
  std::vector<Argument> positionals;
  std::vector<Command> commands;
};

Command command_of(const CLI::App& app);

// These functions return scripts that complete a program's commands, options and listed values in a shell. The scripts
// complete other values with file names.
std::string bash_completion(const Command& program);
std::string fish_completion(const Command& program);
std::string zsh_completion(const Command& program);

/// Returns the manual page (man(7)) of a command. `program` is the name of the program. If `command` has the same name,
/// returns the page of the program itself.
std::string manual_page(const Command& command, const std::string& program, const std::string& version);

}  // namespace mebots::command_line

namespace CLI {  // NOLINT(readability-identifier-naming): that of CLI11
class App;
}

namespace mebots::command_line {

/// Handles two options that --help does not list, because only packages use them. `PROGRAM
/// --print-completion bash|fish|zsh` prints the completion script of a shell. `PROGRAM --write-manuals FOLDER` writes
/// one manual page for the program and one per command. If the command line contains one of these options, returns the
/// exit code. `app` must have its name and all its commands. `version` is printed on the pages.
std::optional<int> handle_hidden_options(const CLI::App& app, const std::string& version, int argument_count,
                                         const char* const* arguments);

}  // namespace mebots::command_line
