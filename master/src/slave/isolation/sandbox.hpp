// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// The sandbox of a host process. It consists of mechanisms, each of which a system may refuse: see kMechanisms.
namespace mebots::master::isolation {

/// What a sandboxed FMU may use.
struct Sandbox {
  std::filesystem::path folder;    ///< the unpacked FMU: read-only
  std::vector<std::string> reads;  ///< further files and folders that it may read
};

/// A mechanism that the system refuses.
struct Refusal {
  std::string mechanism;  ///< one of kMechanisms
  std::string reason;
};

/// Replaces this process by bubblewrap, which starts `program` with `arguments` again: with its own user, process,
/// network, IPC and UTS namespaces, without capabilities, in a tree of files that holds only system libraries,
/// `sandbox` and an empty /tmp. Open descriptors stay open. Returns only if that is impossible.
Refusal enter_namespaces(const Sandbox& sandbox, const std::string& program, const std::vector<std::string>& arguments);

/// Restricts the calling process further: environment, limits, files by Landlock. `has_namespaces`: it was started by
/// enter_namespaces(). Otherwise, the process writes only to a new folder in `sandbox.folder`. Returns the mechanisms
/// that the system refuses. One thread only.
std::vector<Refusal> restrict_process(const Sandbox& sandbox, bool has_namespaces);

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

/// Allows this process the system calls of a simulation; every other one fails with EPERM. With namespaces, it may use
/// sockets and change attributes of files, all of which are private to it then. Calls in the form of another
/// architecture end the process. Returns nothing, or why the system allows no filter.
std::optional<std::string> allow_simulation_calls(bool has_namespaces);

}  // namespace mebots::master::isolation
