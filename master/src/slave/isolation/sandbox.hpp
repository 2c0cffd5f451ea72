// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>
#include <filesystem>
#include <string>
#include <vector>

namespace mebots::master::isolation {

/// Shuts the calling program in, as far as the kernel lets it. It has user, process and network namespaces of its own,
/// no capabilities, and files by Landlock. It reads what programs need (/usr, /etc, /proc ...), and writes below
/// `folder` alone. Returns in a process that the calling one keeps for `master` (see keeper.hpp). Returns what the
/// kernel has not or refuses, one text each. One thread only.
std::vector<std::string> enter_sandbox(const std::filesystem::path& folder, pid_t master);

}  // namespace mebots::master::isolation
