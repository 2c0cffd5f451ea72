// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::master::isolation {

/// Shuts the calling program in, as far as the kernel lets it: user, process and network namespaces of its own, no
/// capabilities, and files by Landlock: it reads what programs need (/usr, /etc, /proc ...), and writes below `folder`
/// alone. Returns in a grandchild of the process that called: that one stands by, ends as the grandchild ends, and
/// takes all that was started inside with it. Returns what the kernel has not or refuses, one text each. One thread
/// only.
std::vector<std::string> enter_sandbox(const std::filesystem::path& folder);

}  // namespace mebots::master::isolation
