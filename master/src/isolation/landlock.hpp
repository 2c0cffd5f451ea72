// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace mebots::master::isolation {

/// From now on this process and its children read and run only what programs need, write only below `folder` and to
/// /dev/null and its like, and send signals to nobody outside. Empty, or why the kernel does not do it.
std::string restrict_files(const std::filesystem::path& folder);

}  // namespace mebots::master::isolation
