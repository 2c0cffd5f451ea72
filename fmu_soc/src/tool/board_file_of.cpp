// SPDX-License-Identifier: Apache-2.0
#include "tool/board_file_of.hpp"

#include <system_error>

namespace mebots::soc::tool {

std::filesystem::path board_file(const std::string& asked) {
  std::error_code error;
  if (std::filesystem::exists(asked, error) || asked.find_first_of("/.") != std::string::npos) return asked;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  // An installation has it in share/, a build beside bin/.
  for (const auto* place : {"share/mebots/configs/boards", "configs/boards"}) {
    auto file = program.parent_path().parent_path() / place / (asked + ".json");
    if (std::filesystem::exists(file, error)) return file;
  }
  return asked;
}

}  // namespace mebots::soc::tool
