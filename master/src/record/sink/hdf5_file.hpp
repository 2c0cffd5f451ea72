// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hdf5.h>

#include <filesystem>
#include <mutex>
#include <string>
#include <utility>

/// Defines types and functions for all writers of HDF5 files.
namespace mebots::master::hdf5 {

/// Returns the mutex that must be held during every call to HDF5, because Debian's HDF5 is not thread-safe.
std::mutex& library();

/// Owns an HDF5 identifier. The destructor closes it.
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

/// Returns the HDF5 type for UTF-8 texts of variable length.
Handle text_type();
bool put_attribute(hid_t object, const char* name, const std::string& text);
/// Replaces each `/` in the name, because HDF5 treats it as a separator.
std::string without_slashes(std::string name);

/// Writes an HDF5 file. If the disk is full or fails, reports an error instead of crashing.
///
/// HDF5 crashes when it closes a file after a failed write. Therefore this class uses a driver that reports no failure
/// to HDF5: the driver stores the first error, and keeps everything that HDF5 writes afterwards in memory. check() and
/// close() throw the stored error.
///
/// The caller must hold library() during each call, including the constructor and the destructor.
class File {
 public:
  /// Creates the file or removes its content. Throws InputError if the file cannot be opened. If writing its first
  /// bytes fails, check() throws the error.
  explicit File(std::filesystem::path path);
  /// Closes the file and ignores errors. Call close() first if errors are needed.
  ~File();
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  hid_t id() const { return id_; }
  const std::filesystem::path& path() const { return path_; }
  /// Sets the path after the file was renamed.
  void renamed(std::filesystem::path path) { path_ = std::move(path); }
  /// Throws Error if a write has failed since the file was created.
  void check() const;
  /// Throws Error with the system's reason for the failed write. If no write failed, HDF5 itself has rejected the call,
  /// and the error contains no reason.
  [[noreturn]] void fail() const;
  /// Writes all buffered data and closes the file. The data sets of the file must have been closed before. If a write
  /// failed, the file is unreadable; in this case, deletes it and throws Error.
  void close();

 private:
  std::filesystem::path path_;
  int error_number_ = 0;  // errno of the first failed write; set by the driver
  hid_t id_ = H5I_INVALID_HID;
};

}  // namespace mebots::master::hdf5
