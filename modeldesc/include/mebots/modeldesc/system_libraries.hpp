// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// Libraries and versions that a shared library needs from the operating system.
namespace mebots::modeldesc {

/// True for libraries that every desktop or server Linux with glibc has, and for those of sanitizers.
bool is_part_of_linux(std::string_view soname);

/// True for a DLL that every 64-bit Windows 10 or newer contains. Windows ignores the case of names.
bool is_part_of_windows(std::string_view dll);

/// Returns the versions of symbols that an ELF library needs of others, such as GLIBC_2.34. Throws the same errors as
/// read_elf_library().
std::vector<std::string> read_needed_versions(const std::filesystem::path& file);

}  // namespace mebots::modeldesc
