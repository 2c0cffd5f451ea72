// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/archive.hpp"

#include "require.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::fuzz {

/// A folder for the files of one input at a time. It is created once, in memory if possible.
class FolderOfInput {
 public:
  const std::filesystem::path& path() const { return folder_.path(); }

  /// Writes the files of an input. The text of the first file is followed by further files, each after a line "===
  /// name". Skips a file if its name leads out of the folder or already exists.
  void fill(std::string_view input, std::string_view first) {
    constexpr std::string_view kMark = "\n=== ";
    std::string_view name = first;
    while (true) {
      const auto end = input.find(kMark);
      if (stays_inside(name)) write_file(std::string(name), input.substr(0, end));
      if (end == std::string_view::npos) return;
      input.remove_prefix(end + kMark.size());
      const auto line = input.find('\n');
      name = input.substr(0, line);
      input.remove_prefix(line == std::string_view::npos ? input.size() : line + 1);
    }
  }

  void clear() {
    for (const auto& file : files_) unlink(file.c_str());
    files_.clear();
  }

 private:
  static bool stays_inside(std::string_view name) {
    constexpr std::size_t kLongest = 64;
    return !name.empty() && name.size() < kLongest && name != "." && name != ".." &&
           name.find_first_of(std::string_view("/\0", 2)) == std::string_view::npos;
  }

  void write_file(const std::string& name, std::string_view text) {
    auto file = folder_.path() / name;
    const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
    if (descriptor < 0) return;
    const bool whole = write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    close(descriptor);
    files_.push_back(std::move(file));
    require(whole, "the input is in its files");
  }

  modeldesc::TemporaryFolder folder_{"mebots-fuzz", std::filesystem::exists("/dev/shm") ? "/dev/shm" : ""};
  std::vector<std::filesystem::path> files_;
};

}  // namespace mebots::fuzz
