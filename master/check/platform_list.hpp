// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::check {

/// The platform of one folder in `binaries/`: the machine for which its libraries were built, and the libraries that
/// they need.
struct PlatformNeeds {
  std::string folder;  ///< name of the folder, such as win64
  /// Machine of the libraries, such as "x86-64 Windows"; empty if no library in the folder is of a known platform.
  std::string machine;
  /// Oldest version of the GNU C library that defines all used symbols; empty if no such symbol is used.
  std::string glibc;
  std::vector<std::string> missing;  ///< needed libraries that are neither in the folder nor part of the system
};

/// Reads the headers of all libraries of an unpacked FMU, for all platforms. Returns the platforms sorted by folder. If
/// a library cannot be read, it counts as a library that needs no other library.
std::vector<PlatformNeeds> list_platforms(const std::filesystem::path& fmu);

/// Returns the needs as a line of text without the folder's name, such as "x86-64 Linux, glibc 2.34 or newer, needs
/// libccd.so.2".
std::string to_text(const PlatformNeeds& needs);

}  // namespace mebots::check
