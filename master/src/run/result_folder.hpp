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

/// Locks a results folder, so that only one run of all processes writes into it. If the process ends for any reason,
/// the kernel releases the lock.
class FolderLock {
 public:
  /// Throws InputError if another run writes into the folder. The error contains the number of that run's process.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

/// The folder that contains the results of a run. The results of an earlier run remain until this run reaches t = 0.
/// New files are first written under other names, and keep() renames them.
class ResultFolder {
 public:
  /// Creates the folder if it does not exist. Throws InputError if this fails, or if another run writes into the
  /// folder.
  explicit ResultFolder(std::filesystem::path path);
  /// Removes the new files if keep() was not called. All other files stay unchanged.
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  /// Creates a new file, which keep() renames to `name`. The returned reference is valid as long as this object exists.
  /// Throws InputError if the file cannot be created.
  OutputFile& create(std::string_view name);
  /// Returns a path at which another component writes a new file. keep() renames this file to `name`.
  std::filesystem::path reserve(std::string_view name);
  /// Opens a file of an earlier run in order to append to it. Throws InputError if this fails.
  OutputFile& reopen(std::string_view name);

  /// Replaces the results of an earlier run by those of this run: renames the new files to their final names, and
  /// deletes the files in `outdated`. Throws InputError if this fails.
  void keep(std::span<const std::string_view> outdated);

  /// Unlocks the folder, so that other runs can write into it.
  void release() { lock_.reset(); }

  bool kept() const { return kept_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::vector<std::filesystem::path> made_;  // folders that were created; the innermost folder is the first
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
