// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hdf5.h>

#include <filesystem>
#include <mutex>
#include <string>
#include <utility>

namespace mebots::master::hdf5 {

/// Returns the mutex that must be locked during every HDF5 call, because Debian's HDF5 is not thread-safe.
std::mutex& library();

/// Owns an HDF5 identifier and closes it in the destructor.
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

/// Returns the HDF5 type of UTF-8 texts with variable length.
Handle text_type();
bool put_attribute(hid_t object, const char* name, const std::string& text);
/// Replaces each `/` in a name. In HDF5, `/` separates the parts of a path.
std::string without_slashes(std::string name);

/// Writes an HDF5 file. Reports errors of the disk as exceptions.
///
/// HDF5 crashes if it closes a file after a failed write. Therefore the file driver of this class hides failures from
/// HDF5: it stores the first error and keeps all later writes in memory. check() and close() throw the stored error.
///
/// The caller must lock library() during each call, including constructor and destructor.
class File {
 public:
  /// Creates the file, or truncates it. Throws InputError if the file cannot be opened. If writing the first bytes
  /// fails, check() throws the error.
  explicit File(std::filesystem::path path);
  /// Closes the file and ignores errors. To receive errors, call close() first.
  ~File();
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  hid_t id() const { return id_; }
  const std::filesystem::path& path() const { return path_; }
  /// Sets the new path of a renamed file.
  void renamed(std::filesystem::path path) { path_ = std::move(path); }
  /// Throws Error if a write has failed.
  void check() const;
  /// Throws Error with the system's reason for the failed write. If no write failed, HDF5 rejected the last call
  /// without a reason.
  [[noreturn]] void fail() const;
  /// Writes all data and closes the file. All datasets of the file must be closed. If a write failed, deletes the file,
  /// which is unreadable, and throws Error.
  void close();

 private:
  std::filesystem::path path_;
  int error_number_ = 0;  // errno of the first failed write, or 0
  hid_t id_ = H5I_INVALID_HID;
};

}  // namespace mebots::master::hdf5
