// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace mebots::master::ssp {

/// A URI that names a file (RFC 3986): a relative reference, or one of scheme `file`.
struct FileUri {
  std::filesystem::path path;
  bool has_backslashes = false;         ///< they are taken as slashes
  std::optional<std::string> by_proxy;  ///< the host through which the FMU was meant to run
};

/// Returns nothing for a URI of another scheme. `proxyfmu://host?file=PATH` of the Open Simulation Platform names the
/// file PATH.
std::optional<FileUri> parse_file_uri(std::string_view uri);

}  // namespace mebots::master::ssp
