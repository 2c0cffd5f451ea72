// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

namespace mebots::data {

/// The file that a String parameter means: a name in `folder` (without .json), or a path, which is whatever
/// holds a slash or ends in .json. `variable` names the parameter in the Error when there is no such file.
std::filesystem::path find_file(const std::filesystem::path& folder, std::string_view name, std::string_view variable);

}  // namespace mebots::data
