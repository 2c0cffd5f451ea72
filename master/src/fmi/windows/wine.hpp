// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace mebots::master::windows {

/// The paths of the programs that run an FMU for Windows. The path of a missing program is empty.
struct Wine {
  std::filesystem::path program;    ///< wine's loader for 64-bit programs
  std::filesystem::path libraries;  ///< folder that contains wine's DLLs
  std::filesystem::path host;       ///< mebots-windows-host.exe
  /// Instruction for the user if a part is missing, such as "Install wine (...)"; otherwise empty.
  std::string missing;

  explicit operator bool() const { return missing.empty(); }
};

/// Finds wine: by $MEBOTS_WINE, otherwise on PATH or where distributions install it. The first call searches; later
/// calls return its result.
const Wine& find_wine();

/// Creates a folder with wine's settings and with links to wine's DLLs. wine itself would need 15 s and 700 MB to
/// create such a folder. Each FMU needs a separate folder, because all programs with the same folder share a
/// wineserver, and a wineserver ends with the process that started it.
void create_wine_settings(const std::filesystem::path& folder);

}  // namespace mebots::master::windows
