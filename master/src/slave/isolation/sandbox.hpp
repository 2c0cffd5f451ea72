// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// The sandbox of a host process. It consists of mechanisms (kMechanisms); a system may refuse any of them.
namespace mebots::master::isolation {

/// The resources that a sandboxed FMU may use.
struct Sandbox {
  std::filesystem::path folder;    ///< the unpacked FMU: read-only
  std::vector<std::string> reads;  ///< further files and folders that it may read
};

/// A mechanism refused by the system.
struct Refusal {
  std::string mechanism;  ///< one of kMechanisms
  std::string reason;
};

/// Replaces this process by bubblewrap, which starts `program` again with `arguments`. The new process has its own
/// user, process, network, IPC and UTS namespaces and no capabilities. Its file tree contains only system libraries,
/// `sandbox` and an empty /tmp. Open descriptors stay open. Returns only if this fails.
Refusal enter_namespaces(const Sandbox& sandbox, const std::string& program, const std::vector<std::string>& arguments);

/// Restricts the calling process further: environment, limits, and files by Landlock. If `has_namespaces` is true,
/// enter_namespaces() has started this process. Otherwise, the process can write only to a new folder in
/// `sandbox.folder`. Returns the mechanisms that the system refuses. One thread only.
std::vector<Refusal> restrict_process(const Sandbox& sandbox, bool has_namespaces);

/// Files and folders, by the access that is permitted. Paths that do not exist are ignored.
struct FileAccess {
  std::vector<std::string> reads;            ///< read and execute, with all contents
  std::vector<std::string> writes;           ///< full access
  std::vector<std::string> writes_in_place;  ///< read and write, such as /dev/null
};

/// Restricts this process and its children to these files. Restricted processes can send signals and connect abstract
/// sockets only to each other. Returns the reason if the kernel refuses this; else empty.
std::optional<std::string> restrict_files(const FileAccess& access);

/// Prevents this process and its children from accessing memory and open files of other processes (since Linux 5.19),
/// and from sending signals to them (since 6.12). Returns true if signals are prevented, too. Access to files does not
/// change. The process must have one thread only.
bool shield_other_processes();

/// Permits only the system calls that a simulation needs; all others fail with EPERM. With namespaces, the process may
/// also use sockets and change attributes of files, because these are private to it. Calls in the form of another
/// architecture end the process. If the system allows no filter, returns the reason; otherwise nullopt.
std::optional<std::string> allow_simulation_calls(bool has_namespaces);

}  // namespace mebots::master::isolation
