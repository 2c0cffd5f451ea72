// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace mebots::master::isolation {

/// Files and folders by what a process may do with them. Paths that do not exist are ignored.
struct FileAccess {
  std::vector<std::string> reads;            ///< read and run what is in them
  std::vector<std::string> writes;           ///< everything
  std::vector<std::string> writes_in_place;  ///< read and write, such as /dev/null
};

/// Restricts this process and its children to these files, and their signals and abstract sockets to each other.
/// Returns nothing, or why the kernel refuses it.
std::optional<std::string> restrict_files(const FileAccess& access);

/// Takes from this process and its children the access to memory and open files of other processes (since Linux 5.19),
/// and to their signals (since 6.12). Returns true for the latter. Access to files stays. One thread only.
bool shield_other_processes();

}  // namespace mebots::master::isolation
