// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/archive.hpp"

#include <filesystem>

namespace mebots::master {

/// A temporary folder with an unpacked FMU. The destructor deletes the folder. A process that creates an UnpackFolder
/// deletes the folders that killed processes have left.
class UnpackFolder {
 public:
  /// Throws Error if there is no folder for temporary files.
  UnpackFolder();
  UnpackFolder(const UnpackFolder&) = delete;
  UnpackFolder& operator=(const UnpackFolder&) = delete;

  /// Permits later folders of this process to use this path. No library in the folder may be loaded. Using a path again
  /// saves memory, because the loader stores every path that it has searched.
  void release_path();

  std::filesystem::path path() const { return folder_.path() / "fmu"; }

 private:
  struct Lock {
    Lock() = default;
    ~Lock();
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;

    int file = -1;
  };

  Lock lock_;  // prevents other processes from deleting the folder
  modeldesc::TemporaryFolder folder_;
};

/// Deletes the folders of killed processes of this user.
void remove_abandoned_unpack_folders();

}  // namespace mebots::master
