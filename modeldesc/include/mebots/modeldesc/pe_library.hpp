// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::modeldesc {

/// The imports and exports of a Windows DLL (PE32+ or PE32).
struct PeLibrary {
  std::vector<std::string> needed;   ///< names of the imported DLLs in the order of the file; delay-loaded ones last
  std::vector<std::string> exports;  ///< names of the exported symbols, in the order of the file
};

/// Reads a DLL. Uses the same headers and tables as the loader of Windows. Throws mebots::Error if the file is not a
/// DLL, or if a table is outside the file.
PeLibrary read_pe_library(const std::filesystem::path& file);

}  // namespace mebots::modeldesc
