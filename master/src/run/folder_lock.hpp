// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace mebots::master {

/// Keeps a results folder to one run at a time, of this process or another. The kernel gives the lock back when its
/// process ends, however that comes about.
class FolderLock {
 public:
  /// Throws InputError, with the process that has the folder, when another run writes into it.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace mebots::master
