// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::modeldesc {

/// What the dynamic section of a 64-bit little-endian ELF shared library says.
struct ElfLibrary {
  std::string soname;               // empty when it has none
  std::vector<std::string> needed;  // in the order of the file
};

/// Throws mebots::Error when the file is no such library.
ElfLibrary read_elf_library(const std::filesystem::path& file);

}  // namespace mebots::modeldesc
