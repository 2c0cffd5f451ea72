// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/archive.hpp"

#include <filesystem>

namespace mebots::master {

/// A temporary folder for an unpacked FMU, which goes with this object. A process that is killed leaves its folders
/// behind; whoever makes the next one removes those whose owner is gone.
class UnpackFolder {
 public:
  /// Throws Error when there is no place for temporary files.
  UnpackFolder();
  UnpackFolder(const UnpackFolder&) = delete;
  UnpackFolder& operator=(const UnpackFolder&) = delete;

  /// No library is loaded from here any more: a later folder of this process may have its path. The loader keeps every
  /// path that it ever looked in.
  void release_path();

  /// Where to unpack to.
  std::filesystem::path path() const { return folder_.path() / "fmu"; }

 private:
  struct Lock {
    Lock() = default;
    ~Lock();
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;

    int file = -1;
  };

  Lock lock_;  // held until the folder is gone, so that nobody else removes it at the same time
  modeldesc::TemporaryFolder folder_;
};

/// Removes the folders that processes of this user left behind when they were killed.
void remove_abandoned_unpack_folders();

}  // namespace mebots::master
