// SPDX-License-Identifier: Apache-2.0
#include "io/find_fmu.hpp"

#include "base/installation.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/input_error.hpp"
#include "mebots/nearest_names.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <string>
#include <utility>

namespace mebots::master {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSuffix = ".fmu";

// After this number of FMUs that cannot be found, neither the folders nor similar names are searched for further ones.
// These searches are slow, and messages show no more problems.
constexpr std::size_t kFullyAnswered = 20;

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

std::string listed(const std::vector<fs::path>& folders) {
  std::vector<std::string> texts;
  texts.reserve(folders.size());
  for (const auto& folder : folders) {
    texts.push_back(folder.string() + (is_folder(folder) ? "" : " (which does not exist)"));
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

}  // namespace

bool is_fmu_name(std::string_view text) {
  return !text.empty() && text.find('/') == std::string_view::npos && !fs::path(text).has_extension() && text != "." &&
         text != "..";
}

std::vector<fs::path> fmu_folders(const fs::path& config_folder) {
  std::vector<fs::path> folders = {fs::absolute(config_folder.empty() ? "." : config_folder).lexically_normal()};
  if (const char* search_path = std::getenv("MEBOTS_FMU_PATH"); search_path != nullptr) {
    append_search_path(search_path, folders);
  }
  const auto own = data_places("fmus");
  folders.insert(folders.end(), own.begin(), own.end());
  return folders;
}

const FmuSearch::Answer& FmuSearch::find(std::string_view text) {
  if (const auto known = answers_.find(text); known != answers_.end()) return known->second;
  auto answer = look_for(text);
  if (!answer.problem.empty()) ++problems_;
  return answers_.emplace(text, std::move(answer)).first->second;
}

FmuSearch::Answer FmuSearch::look_for(std::string_view text) {
  std::error_code error;
  const auto path = config_folder_ / text;  // an absolute path does not change
  const auto status = fs::status(path, error);
  if (!is_fmu_name(text) || fs::is_regular_file(status)) {
    auto found = fs::exists(status) ? fs::canonical(path, error) : fs::path();
    if (!error) return {std::move(found), {}};
    return {{},
            fmt::format("there is no FMU at {} ({}); paths are relative to the config",
                        path.lexically_normal().string(), error.message())};
  }
  if (!folders_) folders_ = fmu_folders(config_folder_);
  // names_ contains all available FMUs, except those in folders that cannot be listed.
  if (problems_ >= kFullyAnswered && !listed_.empty() && !std::ranges::binary_search(names_, text))
    return {{}, problem_of_name(text)};
  for (const auto& folder : *folders_) {
    auto found = fs::canonical(folder / (std::string(text) + std::string(kSuffix)), error);
    if (!error) return {std::move(found), {}};
  }
  return {{}, problem_of_name(text)};
}

std::string FmuSearch::problem_of_name(std::string_view name) {
  if (listed_.empty()) {
    listed_ = listed(*folders_);
    names_ = names_in(*folders_);
  }
  return fmt::format("there is no FMU '{}' ({}{}) in {}. {}Add folders with your own FMUs to MEBOTS_FMU_PATH.", name,
                     name, kSuffix, listed_, problems_ < kFullyAnswered ? suggest(name, names_) + " " : "");
}

fs::path find_fmu(std::string_view text, const fs::path& config_folder) {
  FmuSearch search(config_folder);
  const auto& answer = search.find(text);
  if (!answer.problem.empty()) throw InputError(ErrorCode::fmu_not_found, answer.problem);
  return answer.path;
}

}  // namespace mebots::master
