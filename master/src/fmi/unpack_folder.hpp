// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/archive.hpp"

#include <filesystem>

namespace mebots::master {

/// A temporary folder for an unpacked FMU; the destructor deletes it. A process that is killed leaves its folders
/// behind. The next process that creates such a folder deletes all folders whose process has ended.
class UnpackFolder {
 public:
  /// Throws Error if there is no folder for temporary files.
  UnpackFolder();
  UnpackFolder(const UnpackFolder&) = delete;
  UnpackFolder& operator=(const UnpackFolder&) = delete;

  /// Releases the path for a later folder of this process. No library may be loaded from it any more. Reusing paths
  /// saves memory, because the loader keeps every path that it has searched.
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

/// Deletes the folders that killed processes of this user left behind.
void remove_abandoned_unpack_folders();

}  // namespace mebots::master
