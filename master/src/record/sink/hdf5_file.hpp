// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hdf5.h>

#include <filesystem>
#include <mutex>
#include <string>
#include <utility>

/// Types and functions that all writers of HDF5 files use.
namespace mebots::master::hdf5 {

/// Debian's HDF5 is not thread-safe: hold this mutex during every call.
std::mutex& library();

/// An HDF5 identifier that is closed by its destructor.
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

/// Returns the type for UTF-8 text of variable length.
Handle text_type();
bool put_attribute(hid_t object, const char* name, const std::string& text);
/// Replaces the characters that HDF5 treats as separators.
std::string without_slashes(std::string name);

/// Writes an HDF5 file and reports a full or failing disk without a crash.
///
/// HDF5 crashes when it closes a file after a failed write. Therefore this class uses a driver that never reports a
/// failure: the driver stores the first error and keeps everything that HDF5 writes afterwards in memory. check() and
/// close() report the error.
///
/// The caller must hold library() during each call, also of the constructor and the destructor.
class File {
 public:
  /// Creates or truncates the file. Throws InputError if it cannot be opened; if a write of its first bytes fails,
  /// check() reports this.
  explicit File(std::filesystem::path path);
  /// Closes the file and ignores errors. To get errors, call close() first.
  ~File();
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  hid_t id() const { return id_; }
  const std::filesystem::path& path() const { return path_; }
  /// Sets the file's new path after it was renamed.
  void renamed(std::filesystem::path path) { path_ = std::move(path); }
  /// Throws Error if a write has failed since the file was created.
  void check() const;
  /// Throws Error with the system's reason. If no write failed, HDF5 itself rejected the call, and the error has no
  /// reason.
  [[noreturn]] void fail() const;
  /// Writes all buffered data and closes the file. The file's data sets must be closed before. If a write failed, the
  /// file is unreadable. In this case, deletes the file and throws Error.
  void close();

 private:
  std::filesystem::path path_;
  int error_number_ = 0;  // errno of the first failed write; the driver sets it
  hid_t id_ = H5I_INVALID_HID;
};

}  // namespace mebots::master::hdf5
