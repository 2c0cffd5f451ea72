// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hdf5.h>

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

}  // namespace mebots::master::hdf5
