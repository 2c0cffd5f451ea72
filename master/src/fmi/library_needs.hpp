// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/elf_library.hpp"

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

/// A library that a process would map in addition if it loaded an FMU.
struct NewLibrary {
  std::filesystem::path file;
  modeldesc::ElfLibrary elf;
};

/// Libraries and symbols that an FMU brings and needs, from its ELF files alone.
struct LibraryNeeds {
  std::vector<NewLibrary> libraries;                     ///< the FMU's own first
  std::map<std::string, std::filesystem::path> brought;  ///< by the name that the loader knows it by
  std::set<std::string> names;                           ///< of all libraries that are asked for, at any depth
  std::set<std::filesystem::path> shared;                ///< files that it needs and the process has loaded already
  bool loads_libraries = false;                          ///< it imports dlopen, so all ELF files in the FMU count
  std::string interpreter;                               ///< "a Python interpreter", if it embeds one; else empty

  /// Returns the texts that files of the FMU hold. An FMU that loads a library by its name holds the name.
  std::set<std::string_view> mentioned(const std::vector<std::string_view>& texts) const;
};

/// Reads the library in `file` and all that it needs. `folder` holds the unpacked FMU, `loaded` what the process has.
/// Throws Error if a file is no library.
LibraryNeeds read_library_needs(const std::filesystem::path& file, const std::filesystem::path& folder,
                                const std::vector<modeldesc::LoadedLibrary>& loaded);

/// The loader's names for a library: its SONAME and the name of its file.
bool has_name(const modeldesc::LoadedLibrary& library, const std::string& name);

/// True for the parts of the C library, of which a process has one in any case.
bool is_c_library(std::string_view name);

}  // namespace mebots::master
