// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::app {

/// Executes a command and returns the program's exit code. Called after the command line was parsed.
using Action = std::function<int()>;

/// Adds a command to the parser. If the user gives this command, the parser stores its action in `action`. `action`
/// must exist until it is called.
using AddCommand = void (*)(CLI::App& app, Action& action);

// Each function is in the file <name>_command.cpp.
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

/// Returns the default results folder of a config: results/<name of the config>.
std::filesystem::path default_results(const std::filesystem::path& config);

/// Writes the HTML report of these results folders. If `file` is empty, writes flight.html into the first folder.
/// Returns the path of the report. Throws Error if the report cannot be written.
std::filesystem::path write_report(const std::vector<std::filesystem::path>& folders, std::filesystem::path file);

/// Throws InputError if the parent folder of `file` does not exist.
void require_folder_of(const std::filesystem::path& file);

/// Calls `work` and returns 0. If `work` throws, prints the error and returns 2 for InputError or 1 for other
/// exceptions.
int guarded(const std::function<void()>& work);

/// Prints "mebots: error: " and the text to standard error.
void print_error(const std::string& text);

/// Prints the result of a command and flushes standard output. Throws Error if the output is closed or full.
void print_product(std::string_view text);

/// Returns the sections "Exit codes:" and "Examples:" of a command's help, with one entry per line.
std::string help_footer(const std::vector<std::string>& exit_codes, const std::vector<std::string>& examples);

const CLI::Validator& positive();
const CLI::Validator& not_empty();

/// Replaces this process by a Python interpreter that calls `main()` of `module` with the arguments `words`. Errors
/// name `command`, the user's command, such as "mebots sweep". Never returns. Throws InputError if the mebots package
/// or an interpreter is missing.
void become_python(const std::string& command, const std::string& module, const std::vector<std::string>& words);

}  // namespace mebots::app
