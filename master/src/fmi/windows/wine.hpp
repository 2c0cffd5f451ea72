// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace mebots::master::windows {

/// The programs that run an FMU for Windows. The paths are empty if the programs are missing.
struct Wine {
  std::filesystem::path program;    ///< wine's loader for 64-bit programs
  std::filesystem::path libraries;  ///< folder with wine's own DLLs, beside the program if there is one
  std::filesystem::path host;       ///< mebots-windows-host.exe
  std::string missing;              ///< what to do if a part is missing: "Install wine (...)"

  explicit operator bool() const { return missing.empty(); }
};

/// Finds wine: $MEBOTS_WINE, else on PATH or where distributions install it. Searches in the first call only.
const Wine& find_wine();

/// Creates a folder with wine's settings, and links in it to wine's DLLs. wine itself would take 15 s and 700 MB to
/// create such a folder. Each FMU has its own folder, because all programs of one folder share a wineserver. A
/// wineserver ends with the process that started it.
void create_wine_settings(const std::filesystem::path& folder);

}  // namespace mebots::master::windows
