// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/archive.hpp"

#include <filesystem>

namespace mebots::master {

/// A temporary folder for an unpacked FMU; the destructor deletes it. If a process is killed, its folders remain. The
/// next process that creates such a folder deletes all folders whose process has ended.
class UnpackFolder {
 public:
  /// Throws Error if there is no folder for temporary files.
  UnpackFolder();
  UnpackFolder(const UnpackFolder&) = delete;
  UnpackFolder& operator=(const UnpackFolder&) = delete;

  /// Releases the path, so that a later folder of this process can use it. No library from this folder may still be
  /// loaded. Reusing paths saves memory, because the loader keeps every path that it has searched.
  void release_path();

  /// Returns the folder to unpack into.
  std::filesystem::path path() const { return folder_.path() / "fmu"; }

 private:
  struct Lock {
    Lock() = default;
    ~Lock();
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;

    int file = -1;
  };

  Lock lock_;  // held until the folder is deleted, so that no other process deletes it at the same time
  modeldesc::TemporaryFolder folder_;
};

/// Deletes the folders of those processes of this user that were killed.
void remove_abandoned_unpack_folders();

}  // namespace mebots::master
