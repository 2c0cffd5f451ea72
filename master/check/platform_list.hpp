// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::check {

/// The machine for which the libraries in one folder of `binaries/` were built, and the libraries that they need.
struct PlatformNeeds {
  std::string folder;   ///< its name, such as win64
  std::string machine;  ///< such as "x86-64 Windows"; empty if no library in it is of a known platform
  std::string glibc;    ///< oldest version of the GNU C library that has all symbols; empty if none is used
  std::vector<std::string> missing;  ///< needed libraries that are neither in the folder nor part of the system
};

/// Reads the headers of all libraries of an unpacked FMU, for all platforms. The result is sorted by folder. A library
/// that cannot be read counts as a library that needs no other library.
std::vector<PlatformNeeds> list_platforms(const std::filesystem::path& fmu);

/// Returns a readable line without the folder, such as "x86-64 Linux, glibc 2.34 or newer, needs libccd.so.2".
std::string to_text(const PlatformNeeds& needs);

}  // namespace mebots::check
