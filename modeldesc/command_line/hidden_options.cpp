// SPDX-License-Identifier: Apache-2.0
#include "command_line/command.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <filesystem>
#include <fstream>

namespace mebots::command_line {
namespace {

int fail(const Command& program, const std::string& text) {
  std::fprintf(stderr, "%s: error: %s\n", program.name.c_str(), text.c_str());
  return 2;
}

int print_completion(const Command& program, const std::string& shell) {
  std::string text;
  if (shell == "bash") text = bash_completion(program);
  if (shell == "fish") text = fish_completion(program);
  if (shell == "zsh") text = zsh_completion(program);
  if (text.empty()) return fail(program, "there is no completion for '" + shell + "'; known: bash, fish, zsh");
  return std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0 ? 0 : 1;
}

bool write_page(const std::filesystem::path& file, const std::string& text) {
  std::ofstream output(file, std::ios::binary);
  output << text;
  output.close();
  return !output.fail();
}

int write_manuals(const Command& program, const std::string& version, const std::filesystem::path& folder) {
  const auto write = [&](const Command& command, const std::string& name) {
    const auto file = folder / (name + ".1");
    return write_page(file, manual_page(command, program.name, version))
               ? 0
               : fail(program, file.string() + " cannot be written");
  };
  int code = write(program, program.name);
  for (const auto& command : program.commands) {
    if (code == 0) code = write(command, program.name + "-" + command.name);
  }
  return code;
}

}  // namespace

std::optional<int> handle_hidden_options(const CLI::App& app, const std::string& version, int argument_count,
                                         const char* const* arguments) {
  if (argument_count != 3) return std::nullopt;
  const std::string asked = arguments[1];
  if (asked == "--print-completion") return print_completion(command_of(app), arguments[2]);
  if (asked == "--write-manuals") return write_manuals(command_of(app), version, arguments[2]);
  return std::nullopt;
}

}  // namespace mebots::command_line
