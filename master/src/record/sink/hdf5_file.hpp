// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hdf5.h>

#include <filesystem>
#include <mutex>
#include <string>
#include <utility>

/// What the writers of HDF5 files share.
namespace mebots::master::hdf5 {

/// Debian's HDF5 is not made for threads: one call at a time in the whole process.
std::mutex& library();

/// An HDF5 identifier that closes itself.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor): that is what it stands for

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// UTF-8 of any length.
Handle text_type();
bool put_attribute(hid_t object, const char* name, const std::string& text);
/// A name with what HDF5 takes for a separator replaced.
std::string without_slashes(std::string name);

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
