// SPDX-License-Identifier: Apache-2.0
#include "mebots/master/result_folder.hpp"

#include "mebots/master/input_error.hpp"

#include <fmt/format.h>

namespace mebots::master {
ResultFolder::ResultFolder(std::filesystem::path path) : path_(std::move(path)) {
  std::error_code error;
  for (auto folder = path_; !folder.empty() && !std::filesystem::exists(folder, error); folder = folder.parent_path()) {
    made_.push_back(folder);
  }
  std::filesystem::create_directories(path_, error);
  if (error || !std::filesystem::is_directory(path_)) {
    throw InputError(fmt::format("{}: the results folder cannot be made: {}. Choose another one with --out",
                                 path_.string(), error ? error.message() : "there is a file of this name"));
  }
}

ResultFolder::~ResultFolder() {
  if (kept_) return;
  std::error_code ignored;
  for (const auto& [file, name] : waiting_) std::filesystem::remove(file->path(), ignored);
  for (const auto& folder : made_) std::filesystem::remove(folder, ignored);  // only where it is empty
}

OutputFile& ResultFolder::create(std::string_view name) {
  const auto final_path = path_ / name;
  auto& file = files_.emplace_back(final_path.string() + ".new");
  waiting_.emplace_back(&file, final_path);
  return file;
}

OutputFile& ResultFolder::reopen(std::string_view name) {
  return files_.emplace_back(path_ / name, OutputFile::Mode::go_on);
}

void ResultFolder::keep(std::initializer_list<std::string_view> outdated) {
  kept_ = true;
  std::error_code error;
  for (const auto name : outdated) {
    std::filesystem::remove(path_ / name, error);
    if (error) {
      throw InputError(fmt::format("{}: this file of an earlier run cannot be removed: {}", (path_ / name).string(),
                                   error.message()));
    }
  }
  for (const auto& [file, name] : waiting_) file->rename(name);
  waiting_.clear();
}

}  // namespace mebots::master
