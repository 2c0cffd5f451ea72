// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

namespace mebots::data {

/// Returns the file that a String parameter names. A value that contains a slash or ends in .json is a path; any other
/// is a name in `folder`, without .json. Throws Error that names `variable` if there is no such file.
std::filesystem::path find_file(const std::filesystem::path& folder, std::string_view name, std::string_view variable);

}  // namespace mebots::data
