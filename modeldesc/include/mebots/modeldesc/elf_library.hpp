// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace mebots::modeldesc {

/// What the dynamic section and the dynamic symbols of a 64-bit little-endian ELF shared library say.
struct ElfLibrary {
  std::uint16_t machine = 0;         // EM_X86_64 and so on
  std::string soname;                // empty when it has none
  std::vector<std::string> needed;   // in the order of the file
  std::vector<std::string> rpath;    // DT_RPATH, as written: `$ORIGIN` is not expanded
  std::vector<std::string> runpath;  // DT_RUNPATH
  std::vector<std::string> exports;  // names that it defines for others, in the order of the file
};

/// Throws mebots::Error when the file is not such a library.
ElfLibrary read_elf_library(const std::filesystem::path& file);

}  // namespace mebots::modeldesc
