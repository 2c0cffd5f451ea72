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

/// Locks a results folder for one run at a time, across processes. If the process ends for any reason, the kernel
/// releases its lock.
class FolderLock {
 public:
  /// Throws InputError if another run writes into the folder. The message contains the number of that run's process.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

/// The folder of a run's results. The results of an earlier run remain until this run reaches t = 0. New files are
/// first written under other names, and keep() renames them.
class ResultFolder {
 public:
  /// Creates the folder if it does not exist. Throws InputError if this fails, or if another run writes into it.
  explicit ResultFolder(std::filesystem::path path);
  /// If keep() was not called, removes the new files. Other files stay unchanged.
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  /// Creates a file with this final name. The returned reference is valid as long as this object. Throws InputError.
  OutputFile& create(std::string_view name);
  /// Returns a path at which another component writes a new file. keep() also renames this file.
  std::filesystem::path reserve(std::string_view name);
  /// Opens an earlier run's file to append to it. Throws InputError.
  OutputFile& reopen(std::string_view name);

  /// Replaces an earlier run's results by those of this run: renames the new files to their final names, and deletes
  /// the files in `outdated`. Throws InputError.
  void keep(std::span<const std::string_view> outdated);

  /// Releases the folder for other runs.
  void release() { lock_.reset(); }

  bool kept() const { return kept_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::vector<std::filesystem::path> made_;  // folders, innermost first
  std::optional<FolderLock> lock_;
  std::list<OutputFile> files_;
  struct Waiting {
    std::filesystem::path now;
    std::filesystem::path later;
    OutputFile* file;  // null if another component writes it
  };
  std::vector<Waiting> waiting_;
  bool kept_ = false;
};

}  // namespace mebots::master
