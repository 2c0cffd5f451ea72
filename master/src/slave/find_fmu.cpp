// SPDX-License-Identifier: Apache-2.0
#include "slave/find_fmu.hpp"

#include "base/installation.hpp"
#include "mebots/input_error.hpp"
#include "mebots/nearest_names.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <set>
#include <string>

namespace mebots::master {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSuffix = ".fmu";

void append_search_path(std::string_view search_path, std::vector<fs::path>& folders) {
  while (!search_path.empty()) {
    const auto colon = search_path.find(':');
    const auto folder = search_path.substr(0, colon);
    if (!folder.empty()) folders.push_back(fs::absolute(folder));
    search_path = colon == std::string_view::npos ? "" : search_path.substr(colon + 1);
  }
}

std::vector<std::string> names_in(const std::vector<fs::path>& folders) {
  std::set<std::string> names;
  std::error_code ignored;
  for (const auto& folder : folders) {
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
      if (entry.path().extension() == kSuffix) names.insert(entry.path().stem().string());
    }
  }
  return {names.begin(), names.end()};
}

/// The folders as an error lists them.
std::string listed(const std::vector<fs::path>& folders) {
  std::vector<std::string> texts;
  texts.reserve(folders.size());
  std::error_code ignored;
  for (const auto& folder : folders) {
    texts.push_back(folder.string() + (fs::is_directory(folder, ignored) ? "" : " (which is not there)"));
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

}  // namespace

bool is_fmu_name(std::string_view text) {
  return !text.empty() && text.find('/') == std::string_view::npos && !fs::path(text).has_extension() && text != "." &&
         text != "..";
}

std::vector<fs::path> fmu_folders(const fs::path& beside) {
  std::vector<fs::path> folders = {fs::absolute(beside.empty() ? "." : beside).lexically_normal()};
  if (const char* search_path = std::getenv("MEBOTS_FMU_PATH"); search_path != nullptr) {
    append_search_path(search_path, folders);
  }
  const auto own = data_places("fmus");
  folders.insert(folders.end(), own.begin(), own.end());
  return folders;
}

fs::path find_fmu(std::string_view text, const fs::path& beside) {
  std::error_code error;
  const auto path = beside / text;  // an absolute path stays as it is
  if (!is_fmu_name(text) || fs::is_regular_file(path, error)) {
    auto found = fs::canonical(path, error);
    if (!error) return found;
    throw InputError(ErrorCode::fmu_not_found,
                     fmt::format("there is no FMU at {} ({}); paths are relative to the config",
                                 path.lexically_normal().string(), error.message()));
  }
  const auto folders = fmu_folders(beside);
  for (const auto& folder : folders) {
    auto found = fs::canonical(folder / (std::string(text) + std::string(kSuffix)), error);
    if (!error) return found;
  }
  throw InputError(
      ErrorCode::fmu_not_found,
      fmt::format("there is no FMU '{}' ({}{}) in {}. {} Folders with your own FMUs go into MEBOTS_FMU_PATH.", text,
                  text, kSuffix, listed(folders), suggest(text, names_in(folders))));
}

}  // namespace mebots::master
