// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace mebots {

/// The whole content of a file or a pipe. Throws Error naming it and why it cannot be read; a device such as /dev/zero,
/// which may never end, is not a file.
std::string text_of(const std::filesystem::path& path);

}  // namespace mebots
