// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::app {

/// What a command does once the command line is read. Returns the program's exit code.
using Action = std::function<int()>;

/// Adds one command to the parser. When that command is given, the parser stores what it does in `action`, which
/// outlives the parsing.
using AddCommand = void (*)(CLI::App& app, Action& action);

// One per command, each in a file of its own: <name>_command.cpp.
void add_check(CLI::App& app, Action& action);
void add_convert(CLI::App& app, Action& action);
void add_demo(CLI::App& app, Action& action);
void add_deploy(CLI::App& app, Action& action);
void add_identify(CLI::App& app, Action& action);
void add_info(CLI::App& app, Action& action);
void add_new_cell(CLI::App& app, Action& action);
void add_new_firmware(CLI::App& app, Action& action);
void add_new_fmu(CLI::App& app, Action& action);
void add_new_sensor(CLI::App& app, Action& action);
void add_replay(CLI::App& app, Action& action);
void add_report(CLI::App& app, Action& action);
void add_resume(CLI::App& app, Action& action);
void add_run(CLI::App& app, Action& action);
void add_schema(CLI::App& app, Action& action);
void add_sweep(CLI::App& app, Action& action);
void add_test(CLI::App& app, Action& action);
void add_units(CLI::App& app, Action& action);
void add_validate(CLI::App& app, Action& action);

/// Where the results of a config go unless somebody says otherwise: results/<name of the config>.
std::filesystem::path default_results(const std::filesystem::path& config);

/// Writes the page of these results folders, as `mebots report` does; `file` empty = flight.html in the first of them.
/// Returns the file. Throws Error.
std::filesystem::path write_report(const std::vector<std::filesystem::path>& folders, std::filesystem::path file);

/// Throws InputError when the folder of a file that is to be written is not there.
void require_folder_of(const std::filesystem::path& file);

/// Does the work and returns 0; prints what it throws, and returns 2 for InputError, 1 for anything else.
int guarded(const std::function<void()>& work);

/// Prints "mebots: error: ..." to standard error.
void print_error(const std::string& text);

/// Writes a command's product to standard output, behind what stands there. Throws Error when the output is closed or
/// full.
void print_product(std::string_view text);

/// The footer of a command's help: "Exit codes: ..." and "Examples: ...", one per line.
std::string help_footer(const std::vector<std::string>& exit_codes, const std::vector<std::string>& examples);

/// A number greater than 0.
const CLI::Validator& positive();
/// Any text but the empty one.
const CLI::Validator& not_empty();

/// For commands that are written in Python: this program becomes the interpreter that runs `main()` of `module`
/// ("mebots.exploration.command") with these words. `command` names in errors what the user asked for ("mebots sweep").
/// Does not return but by an exception: InputError where the package or an interpreter is missing.
void become_python(const std::string& command, const std::string& module, const std::vector<std::string>& words);

}  // namespace mebots::app
