// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "assembler.hpp"

#include <filesystem>
#include <string>
#include <string_view>

namespace mebots::soc::test {

/// A folder of its own that goes away.
class Folder {
 public:
  Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder();

  std::string operator/(std::string_view name) const { return (path_ / name).string(); }
  /// Assembles a program into a file of this folder and gives its path.
  std::string program(std::string_view text, std::uint32_t address = 0x80000000) const;

 private:
  std::filesystem::path path_;
};

struct Outcome {
  int exit_code = -1;
  std::string out;
  std::string err;
};

/// Runs `mebots-soc` with these arguments (as the shell reads them).
Outcome run_tool(const std::string& arguments);
/// Its path, quoted for the shell.
std::string tool_path();

std::string read_text(const std::string& path);
void write_text(const std::string& path, std::string_view text);

/// Ends a program with a value in tohost; `tohost` is a double word, aligned.
inline constexpr std::string_view kTohost = R"(
    .section .tohost, "aw"
    .balign 64
    .globl tohost
tohost: .dword 0
    .text
)";

}  // namespace mebots::soc::test
