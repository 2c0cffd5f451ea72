// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "record/sink/output_file.hpp"

#include <filesystem>
#include <list>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace mebots::master {

/// Locks a results folder, so that only one run of all processes writes into it. The kernel releases the lock when the
/// process ends.
class FolderLock {
 public:
  /// Throws InputError with the process number of the other run if the folder is locked.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

/// The folder for the results of a run. New files have temporary names until keep() renames them, so that the results
/// of an earlier run remain.
class ResultFolder {
 public:
  /// Creates and locks the folder. Throws InputError if this fails, or if another run has locked the folder.
  explicit ResultFolder(std::filesystem::path path);
  /// If keep() was not called, removes the new files and the folders that this object created.
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  /// Creates a file that keep() renames to `name`. The reference is valid as long as this object exists. Throws
  /// InputError if the file cannot be created.
  OutputFile& create(std::string_view name);
  /// Returns a path at which the caller creates a new file. keep() renames this file to `name`.
  std::filesystem::path reserve(std::string_view name);
  /// Opens a file of an earlier run for appending. Throws InputError if this fails.
  OutputFile& reopen(std::string_view name);

  /// Renames the new files to their final names and deletes the files in `outdated`. Throws InputError if this fails.
  void keep(std::span<const std::string_view> outdated);

  void release() { lock_.reset(); }

  bool kept() const { return kept_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::vector<std::filesystem::path> made_;  // folders that this object created, the innermost first
  std::optional<FolderLock> lock_;
  std::list<OutputFile> files_;
  struct Waiting {
    std::filesystem::path now;
    std::filesystem::path later;
    OutputFile* file;  // null if another component writes the file
  };
  std::vector<Waiting> waiting_;
  bool kept_ = false;
};

}  // namespace mebots::master
