// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/archive.hpp"

#include <filesystem>
#include <fstream>
#include <string_view>

namespace mebots::fuzz {

/// The files that an input stands for: the first one, then further ones, each after a line "=== name". Names that leave
/// the folder are left out: what the reader looks for there is not there.
inline void write_files(std::string_view input, std::string_view first, const std::filesystem::path& folder) {
  constexpr std::string_view kMark = "\n=== ";
  constexpr std::size_t kLongestName = 64;
  std::string_view name = first;
  while (true) {
    const auto end = input.find(kMark);
    if (!name.empty() && name.size() < kLongestName &&
        name.find_first_of(std::string_view("/\0", 2)) == std::string_view::npos && name != "." && name != "..") {
      const auto text = input.substr(0, end);
      std::ofstream(folder / name, std::ios::binary).write(text.data(), static_cast<std::streamsize>(text.size()));
    }
    if (end == std::string_view::npos) return;
    input.remove_prefix(end + kMark.size());
    const auto line = input.find('\n');
    name = input.substr(0, line);
    input.remove_prefix(line == std::string_view::npos ? input.size() : line + 1);
  }
}

/// In memory, where the system has such a folder.
inline modeldesc::TemporaryFolder fast_folder() {
  return modeldesc::TemporaryFolder("mebots-fuzz", std::filesystem::exists("/dev/shm") ? "/dev/shm" : "");
}

}  // namespace mebots::fuzz
