// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/archive.hpp"

#include <filesystem>

namespace mebots::master {

/// A temporary folder that contains an unpacked FMU; the destructor deletes it. If a process is killed, its folders
/// remain. The next process that creates an UnpackFolder deletes the remaining folders of ended processes.
class UnpackFolder {
 public:
  /// Throws Error if there is no folder for temporary files.
  UnpackFolder();
  UnpackFolder(const UnpackFolder&) = delete;
  UnpackFolder& operator=(const UnpackFolder&) = delete;

  /// Makes the path available to later folders of this process. No library in this folder may still be loaded. Reusing
  /// a path saves memory, because the loader keeps every path that it has searched.
  void release_path();

  /// Returns the folder into which the FMU is to be unpacked.
  std::filesystem::path path() const { return folder_.path() / "fmu"; }

 private:
  struct Lock {
    Lock() = default;
    ~Lock();
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;

    int file = -1;
  };

  Lock lock_;  // held until the folder is deleted, so that no other process deletes the folder at the same time
  modeldesc::TemporaryFolder folder_;
};

/// Deletes the folders that killed processes of this user have left.
void remove_abandoned_unpack_folders();

}  // namespace mebots::master
