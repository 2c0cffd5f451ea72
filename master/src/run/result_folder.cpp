// SPDX-License-Identifier: Apache-2.0
#include "run/result_folder.hpp"

#include "mebots/input_error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace mebots::master {
ResultFolder::ResultFolder(std::filesystem::path path) : path_(std::move(path)) {
  std::error_code error;
  for (auto folder = path_; !folder.empty() && !std::filesystem::exists(folder, error); folder = folder.parent_path()) {
    made_.push_back(folder);
  }
  std::filesystem::create_directories(path_, error);
  if (error || !std::filesystem::is_directory(path_)) {
    throw InputError(ErrorCode::file_unwritable,
                     fmt::format("{}: the results folder cannot be made: {}. Choose another one with --out",
                                 path_.string(), error ? error.message() : "there is a file of this name"));
  }
  lock_.emplace(path_);
}

ResultFolder::~ResultFolder() {
  std::error_code ignored;
  for (const auto& waiting : waiting_) std::filesystem::remove(waiting.now, ignored);
  if (kept_) return;
  lock_.reset();                                                              // its file would keep the folder
  for (const auto& folder : made_) std::filesystem::remove(folder, ignored);  // only where it is empty
}

OutputFile& ResultFolder::create(std::string_view name) {
  auto& file = files_.emplace_back(reserve(name));
  waiting_.back().file = &file;
  return file;
}

std::filesystem::path ResultFolder::reserve(std::string_view name) {
  const auto later = path_ / name;
  waiting_.push_back({later.string() + ".new", later, nullptr});
  return waiting_.back().now;
}

OutputFile& ResultFolder::reopen(std::string_view name) {
  return files_.emplace_back(path_ / name, OutputFile::Mode::go_on);
}

void ResultFolder::keep(std::span<const std::string_view> outdated) {
  kept_ = true;
  std::error_code error;
  for (const auto name : outdated) {
    const auto replaced = [&](const Waiting& waiting) { return waiting.later == path_ / name; };
    if (std::any_of(waiting_.begin(), waiting_.end(), replaced)) continue;
    std::filesystem::remove(path_ / name, error);
    if (error) {
      throw InputError(ErrorCode::file_unwritable, fmt::format("{}: this file of an earlier run cannot be removed: {}",
                                                               (path_ / name).string(), error.message()));
    }
  }
  for (const auto& [now, later, file] : waiting_) {
    if (file != nullptr) {
      file->rename(later);
    } else {
      rename_file(now, later);
    }
  }
  waiting_.clear();
}

}  // namespace mebots::master
