// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hdf5.h>

#include <filesystem>
#include <utility>

namespace mebots::master::hdf5 {

/// Writes an HDF5 file, and reports a full or broken disk without a crash.
///
/// HDF5 crashes when it closes a file after one of its writes has failed. This class gives it a driver that never
/// reports a failure: the driver remembers the first error, and keeps in memory what HDF5 writes from then on. The
/// caller learns of the error from check() and close().
///
/// Hold library() during each call, construction and destruction included.
class File {
 public:
  /// Makes or empties the file. Throws InputError when it cannot be opened; check() reports a failed write of its first
  /// bytes.
  explicit File(std::filesystem::path path);
  /// Closes the file and ignores errors: call close() first to learn of them.
  ~File();
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  hid_t id() const { return id_; }
  const std::filesystem::path& path() const { return path_; }
  /// Takes the name that the file has now.
  void renamed(std::filesystem::path path) { path_ = std::move(path); }
  /// Throws Error if a write has failed since the file was made.
  void check() const;
  /// Throws Error with the system's reason, or without one if no write has failed and HDF5 itself refused the call.
  [[noreturn]] void fail() const;
  /// Writes the rest and closes the file; close its data sets first. If any write has failed, removes the file, which
  /// cannot be read, and throws Error.
  void close();

 private:
  std::filesystem::path path_;
  int error_number_ = 0;  // errno of the first failed write; the driver sets it
  hid_t id_ = H5I_INVALID_HID;
};

}  // namespace mebots::master::hdf5
