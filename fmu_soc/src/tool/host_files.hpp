// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mebots::soc::tool {

/// The host's files as a program sees them: 0, 1 and 2 are the console, of which nothing can be read, and whatever it
/// opens lies below one folder. Answers below 0 are -errno.
class HostFiles {
 public:
  /// Without a folder there is the console only.
  explicit HostFiles(const std::optional<std::string>& folder);

  /// `mode` as of fopen. ":tt" is the console.
  int open(const std::string& name, const char* mode);
  int close(int file);
  /// How many bytes; 0 at the end.
  int read(int file, std::span<char> into);
  int write(int file, std::span<const char> bytes);
  /// The new place; `origin` as of fseek.
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
  static constexpr int kFirstFile = 3;

  std::optional<std::filesystem::path> inside(const std::string& name) const;
  std::FILE* file_of(int file) const;
  int keep(std::FILE* file);

  std::optional<std::filesystem::path> folder_;
  std::vector<File> files_;  // from kFirstFile on
};

}  // namespace mebots::soc::tool
