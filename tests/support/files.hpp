// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace mebots::test {

/// A temporary folder, deleted by the destructor. Its name contains a space, as users' folders may, except for tests
/// with a tool that does not support spaces.
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

/// Returns the bytes of a file; empty if it cannot be read.
std::string read_file(const std::filesystem::path& file);

/// Writes a file. Throws std::runtime_error if that fails.
void write_file(const std::filesystem::path& file, std::string_view bytes);

}  // namespace mebots::test
