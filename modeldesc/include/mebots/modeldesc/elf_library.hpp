// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace mebots::modeldesc {

/// A dynamic symbol that is visible to other libraries.
struct ElfSymbol {
  std::string name;
  bool defined = false;      ///< true: this library defines the symbol; false: the library imports it
  bool weak = false;         ///< an undefined weak symbol may stay undefined
  bool unique = false;       ///< STB_GNU_UNIQUE: the loader keeps one definition for the whole process
  bool bound = false;        ///< true: a relocation of the library names the symbol, so the loader looks it up
  bool preemptible = false;  ///< true: defined here, but a lookup may find another library's definition first
  std::string constant;      ///< the bytes of a unique symbol in read-only memory; otherwise empty
};

/// The dynamic section and the dynamic symbols of a 64-bit little-endian ELF shared library.
struct ElfLibrary {
  std::uint16_t machine = 0;         ///< EM_X86_64 and so on
  std::string soname;                ///< empty if the library has none
  std::vector<std::string> needed;   ///< file names of the libraries that this library needs, in the order of the file
  std::vector<std::string> rpath;    ///< DT_RPATH, as written: `$ORIGIN` is not expanded
  std::vector<std::string> runpath;  ///< DT_RUNPATH
  bool symbolic = false;             ///< DF_SYMBOLIC: the loader looks up symbols in this library first
  std::vector<ElfSymbol> symbols;    ///< in the order of the file

  std::vector<std::string> exports() const;
  std::vector<std::string> imports() const;
};

/// Reads a shared library. Like the loader, uses the program headers and not the sections, which may be stripped.
/// Throws mebots::Error if the file is not a 64-bit little-endian shared library.
ElfLibrary read_elf_library(const std::filesystem::path& file);

/// The libraries that a library needs, and the symbol versions that it requires of them.
struct ElfNeeds {
  std::vector<std::string> libraries;  ///< in the order of the file
  std::vector<std::string> versions;   ///< versions of their symbols, such as GLIBC_2.34
};

/// Reads a little-endian shared library of 32 or 64 bits. Throws mebots::Error if the file is not such a library.
ElfNeeds read_elf_needs(const std::filesystem::path& file);

/// Replaces `$ORIGIN` in the folders of DT_RPATH or DT_RUNPATH by the folder that contains the library `file`.
std::vector<std::string> search_folders(const std::vector<std::string>& paths, const std::filesystem::path& file);

struct LoadedLibrary {
  std::filesystem::path file;  ///< path from the loader; empty for the program itself
  std::string soname;
  std::vector<std::string> needed;
  std::vector<ElfSymbol> unique;  ///< the unique symbols that the library defines, if requested
};

/// Lists the libraries that this process has loaded. Reads their data from memory, because the files may be deleted.
enum class UniqueSymbols { skip, read };
std::vector<LoadedLibrary> loaded_libraries(UniqueSymbols unique);

}  // namespace mebots::modeldesc
