// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "assembler.hpp"
#include "support/files.hpp"

#include <string>
#include <string_view>

namespace mebots::soc::test {

using mebots::test::read_file;
using mebots::test::write_file;

/// A temporary folder. Its operator/ returns a string, which tests insert into their commands.
class Folder : public mebots::test::Folder {
 public:
  Folder() : mebots::test::Folder("mebots-tools") {}

  std::string operator/(std::string_view name) const { return (path() / name).string(); }
  /// Assembles a program into a file of this folder, and returns the file's path.
  std::string program(std::string_view text, std::uint32_t address = 0x80000000) const;
};

struct Outcome {
  int exit_code = -1;
  std::string out;
  std::string err;
};

/// Runs `mebots-soc` with these arguments, which a shell reads.
Outcome run_tool(const std::string& arguments);
/// Runs a program that is given as assembly text. The text is followed by the definition of tohost.
Outcome run_program(std::string_view text, const std::string& options = "");
/// Returns the path of `mebots-soc`, quoted for the shell.
std::string tool_path();

/// Defines the double word `tohost`, aligned. A program ends when it stores a value in it.
inline constexpr std::string_view kTohost = R"(
    .section .tohost, "aw"
    .balign 64
    .globl tohost
tohost: .dword 0
    .text
)";

}  // namespace mebots::soc::test
