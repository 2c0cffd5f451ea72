// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mebots::soc {

/// The sections of a program that lines of its source stand in; empty where the file has none.
struct LineSections {
  std::vector<std::uint8_t> line;         // .debug_line
  std::vector<std::uint8_t> line_string;  // .debug_line_str
  std::vector<std::uint8_t> string;       // .debug_str
};

/// A line of a source file, "camera.c:41".
struct SourceLine {
  std::string file;  ///< without its folders
  std::uint32_t line = 0;

  std::string text() const;
};

/// The line that the instruction at `address` comes from; nothing where the sections do not say it, or are not what
/// they should be. Reads all of them: meant for messages. Source: DWARF 5, 6.2 (versions 2 to 5, 32 bits).
/// Own code, since an FMU must be one file, and neither libdw nor libdwarf can be linked into a shared library
/// statically.
std::optional<SourceLine> find_line(const LineSections& sections, std::uint32_t address);

}  // namespace mebots::soc
