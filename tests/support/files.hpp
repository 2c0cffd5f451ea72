// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace mebots::test {

/// A temporary folder, which the destructor deletes. By default, its name contains a space, as users' folders may. Some
/// tools need a name without a space.
class Folder {
 public:
  explicit Folder(std::string_view name = "mebots test");
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder();

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(std::string_view name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// Returns the bytes of a file; empty if the file cannot be read.
std::string read_file(const std::filesystem::path& file);

/// Throws std::runtime_error if the file cannot be written.
void write_file(const std::filesystem::path& file, std::string_view bytes);

}  // namespace mebots::test
