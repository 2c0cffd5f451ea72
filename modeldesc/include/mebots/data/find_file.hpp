// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

namespace mebots::data {

/// Finds the file that a String parameter selects. If `name` contains a slash or ends in .json, it is a path. Otherwise
/// it is the name of a file in `folder`, without .json. If the file does not exist, throws Error that names the
/// parameter `variable`.
std::filesystem::path find_file(const std::filesystem::path& folder, std::string_view name, std::string_view variable);

}  // namespace mebots::data
