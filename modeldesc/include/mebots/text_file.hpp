// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace mebots {

/// Returns the content of a file or pipe. If the file cannot be read, throws Error with the file's name and the reason.
/// Rejects devices such as /dev/zero, which may never end.
std::string text_of(const std::filesystem::path& path);

}  // namespace mebots
