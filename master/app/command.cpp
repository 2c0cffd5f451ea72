// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"

#include "io/config/load_system.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/input_error.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>

namespace mebots::app {

void print_error(const std::string& text) {
  std::fprintf(stderr, "mebots: error: %s\n", text.c_str());
}

void print_product(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    throw Error(ErrorCode::file_unwritable, fmt::format("standard output: {}", std::strerror(errno)));
  }
}

int guarded(const std::function<void()>& work) {
  try {
    work();
    return 0;
  } catch (const InputError& error) {
    print_error(error.what());
    return 2;
  } catch (const std::exception& error) {
    print_error(error.what());
    return 1;
  }
}

std::filesystem::path default_results(const std::filesystem::path& config) {
  return std::filesystem::path("results") / master::system_name(config);
}

std::string help_footer(const std::vector<std::string>& exit_codes, const std::vector<std::string>& examples) {
  std::string text = "Exit codes:\n";
  for (const auto& code : exit_codes) text += "  " + code + "\n";
  text += "Examples:\n";
  for (const auto& example : examples) text += "  " + example + "\n";
  return text;
}

const CLI::Validator& positive() {
  static const CLI::Validator kPositive(
      [](std::string& text) -> std::string {
        double number = 0;
        if (CLI::detail::lexical_cast(text, number) && std::isfinite(number) && number > 0) return "";
        return text + " is not a number greater than 0";
      },
      "POSITIVE");
  return kPositive;
}

void require_folder_of(const std::filesystem::path& file) {
  const auto folder = file.parent_path();
  if (folder.empty() || is_folder(folder)) return;
  throw InputError(ErrorCode::invalid_argument,
                   fmt::format("{}: there is no folder {}; create it first", file.string(), folder.string()));
}

const CLI::Validator& not_empty() {
  static const CLI::Validator kNotEmpty(
      [](std::string& text) -> std::string { return text.empty() ? "the name is empty" : ""; }, "");
  return kNotEmpty;
}

}  // namespace mebots::app
