// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tool/console.hpp"

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mebots::soc::tool {

/// The host's files for a program: 0 and 1 are the console, 2 is standard error. Other files must be below one folder.
/// Negative results are -errno.
class HostFiles {
 public:
  /// If there is no folder, a program can use only the console. The console must outlive this object.
  HostFiles(const std::optional<std::string>& folder, Console& console);

  /// Opens a file with flags of POSIX's open(). ":tt" is the console.
  int open(const std::string& name, int flags);
  int close(int file);
  /// Returns the number of bytes read; 0 at the end.
  long read(int file, std::span<char> into);
  long write(int file, std::span<const char> bytes);
  /// Returns the new position. `origin` has the values of fseek().
  long seek(int file, long offset, int origin);
  long length(int file);
  int remove(const std::string& name);
  int rename(const std::string& from, const std::string& to);
  static bool is_console(int file) { return file >= 0 && file < kFirstFile; }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  using File = std::unique_ptr<std::FILE, Close>;
  static constexpr int kStandardError = 2;
  static constexpr int kFirstFile = 3;

  std::optional<std::filesystem::path> inside(const std::string& name) const;
  std::FILE* file_of(int file) const;
  int keep(std::FILE* file);

  Console& console_;
  std::optional<std::filesystem::path> folder_;
  std::vector<File> files_;  // from kFirstFile on
};

}  // namespace mebots::soc::tool
