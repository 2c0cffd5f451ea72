// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::check {

/// The platform of a folder in binaries/, and the needs of its libraries.
struct PlatformNeeds {
  std::string folder;  ///< name of the folder, such as win64
  /// Machine of the libraries, such as "x86-64 Windows". Empty if no library is for a known platform.
  std::string machine;
  /// Oldest version of the GNU C library that defines all used symbols. Empty if no such symbol is used.
  std::string glibc;
  std::vector<std::string> missing;  ///< needed libraries that are neither in the folder nor part of the system
};

/// Reads the library headers of all platforms of an unpacked FMU. Returns the platforms sorted by folder. A library
/// that cannot be read counts as a library without needs.
std::vector<PlatformNeeds> list_platforms(const std::filesystem::path& fmu);

/// Returns the needs as one line, such as "x86-64 Linux, glibc 2.34 or newer, needs libccd.so.2".
std::string to_text(const PlatformNeeds& needs);

}  // namespace mebots::check
