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

/// Lets a program access files of the host. Numbers 0 and 1 are the console, and 2 is standard error. Other files must
/// be inside one folder. Negative results are -errno.
class HostFiles {
 public:
  /// If `folder` is empty, the program can use only the console. The console must outlive this object.
  HostFiles(const std::optional<std::string>& folder, Console& console);

  /// Opens a file. `flags` are those of POSIX's open(). The name ":tt" opens the console.
  int open(const std::string& name, int flags);
  int close(int file);
  /// Reads into `into`. Returns the number of bytes, or 0 at the end of the file.
  long read(int file, std::span<char> into);
  long write(int file, std::span<const char> bytes);
  /// Changes the position in a file, and returns the new position. `origin` is that of fseek().
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
  std::vector<File> files_;  // open files; the first one has the number kFirstFile
};

}  // namespace mebots::soc::tool
