// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace mebots::master::windows {

/// The programs that run an FMU for Windows. The path of a missing program is empty.
struct Wine {
  std::filesystem::path program;    ///< loader of wine for 64-bit programs
  std::filesystem::path libraries;  ///< folder with the DLLs of wine
  std::filesystem::path host;       ///< mebots-windows-host.exe
  /// Instruction for the user if a part is missing, such as "Install wine (...)"; otherwise empty.
  std::string missing;

  explicit operator bool() const { return missing.empty(); }
};

/// Finds wine by $MEBOTS_WINE, on PATH, or where distributions install it. Searches only once.
const Wine& find_wine();

/// Creates a folder with the settings of wine and links to its DLLs. wine itself needs 15 s and 700 MB to create such a
/// folder. Each FMU needs its own folder. Programs with the same folder share a wineserver, which ends with the process
/// that started it.
void create_wine_settings(const std::filesystem::path& folder);

}  // namespace mebots::master::windows
