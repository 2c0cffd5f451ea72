// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::app {

/// Executes a command. Called after the command line was parsed. Returns the program's exit code.
using Action = std::function<int()>;

/// Adds a command to the parser. If the command is given, the parser stores its action in `action`, which must exist
/// until the action is called.
using AddCommand = void (*)(CLI::App& app, Action& action);

// Each command has its own function and file: <name>_command.cpp.
void add_check(CLI::App& app, Action& action);
void add_convert(CLI::App& app, Action& action);
void add_demo(CLI::App& app, Action& action);
void add_deploy(CLI::App& app, Action& action);
void add_fmu_platforms(CLI::App& app, Action& action);
void add_identify(CLI::App& app, Action& action);
void add_info(CLI::App& app, Action& action);
void add_link(CLI::App& app, Action& action);
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

/// Returns the default folder for the results of a config: results/<name of the config>.
std::filesystem::path default_results(const std::filesystem::path& config);

/// Writes the HTML report of these results folders, as `mebots report` does. If `file` is empty, writes flight.html
/// into the first folder. Returns the path of the written file. Throws Error if the report cannot be written.
std::filesystem::path write_report(const std::vector<std::filesystem::path>& folders, std::filesystem::path file);

/// Throws InputError if the folder in which a file is to be written does not exist.
void require_folder_of(const std::filesystem::path& file);

/// Calls `work` and returns 0. If `work` throws, prints the exception. Returns 2 for InputError and 1 for all other
/// exceptions.
int guarded(const std::function<void()>& work);

/// Prints "mebots: error: ", followed by the text, to standard error.
void print_error(const std::string& text);

/// Writes a command's result to standard output, after all text that was printed before. Throws Error if the output is
/// closed or full.
void print_product(std::string_view text);

/// Returns the footer of a command's help: the sections "Exit codes:" and "Examples:", with one entry per line.
std::string help_footer(const std::vector<std::string>& exit_codes, const std::vector<std::string>& examples);

/// Returns a validator that accepts numbers greater than 0.
const CLI::Validator& positive();
/// Returns a validator that accepts any text that is not empty.
const CLI::Validator& not_empty();

/// Replaces this program by a Python interpreter, which calls `main()` of `module` (such as
/// "mebots.exploration.command") with the arguments `words`. `command` is the user's command, such as "mebots sweep";
/// errors quote it. Never returns. Throws InputError if the mebots package or an interpreter is missing.
void become_python(const std::string& command, const std::string& module, const std::vector<std::string>& words);

}  // namespace mebots::app
