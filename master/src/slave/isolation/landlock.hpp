// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace mebots::master::isolation {

/// From now on this process and its children read and run only what programs need, write only below `folder` and to
/// /dev/null and its like, and send signals to nobody outside. Empty, or why the kernel does not do it.
std::string restrict_files(const std::filesystem::path& folder);

/// From now on this process and its children have no access to what other processes have in memory and open (since
/// Linux 5.19), and send them no signals (since 6.12). True where the latter holds. Files are as they were. One thread
/// only.
bool shield_other_processes();

}  // namespace mebots::master::isolation
