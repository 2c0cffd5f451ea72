// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mebots::soc {

/// Sections of a program that contain line numbers. A section that the file lacks is empty.
struct LineSections {
  std::vector<std::uint8_t> line;         // .debug_line
  std::vector<std::uint8_t> line_string;  // .debug_line_str
  std::vector<std::uint8_t> string;       // .debug_str
};

/// A line of a source file, such as line 41 of camera.c.
struct SourceLine {
  std::string file;  ///< file name without folders
  std::uint32_t line = 0;

  std::string text() const;
};

/// A contiguous range of code that belongs to one source line.
struct LineRange {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  std::string file;  ///< file name with folders, as it was passed to the compiler
  std::uint32_t line = 0;
};

/// Returns the address ranges of the lines of all statements, in the order of the sections. If a unit is damaged,
/// returns its ranges up to the damage.
std::vector<LineRange> all_lines(const LineSections& sections);

/// Returns the source line of the instruction at `address`, or nullopt if the sections are damaged or do not contain
/// the address. Reads all sections at each call, which is fast enough for messages. Source: DWARF 5, 6.2 (versions 2 to
/// 5, 32 bits). libdw and libdwarf are not used, because they cannot be linked statically into the shared library of an
/// FMU.
std::optional<SourceLine> find_line(const LineSections& sections, std::uint32_t address);

}  // namespace mebots::soc
