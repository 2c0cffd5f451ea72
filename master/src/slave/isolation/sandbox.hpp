// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Creates the sandbox of a host process. It consists of several mechanisms (kMechanisms), each of which may be missing
/// in a system.
namespace mebots::master::isolation {

/// The files that a sandboxed FMU may access.
struct Sandbox {
  std::filesystem::path folder;    ///< folder of the unpacked FMU; read-only
  std::vector<std::string> reads;  ///< additional files and folders that the FMU may read
};

/// Describes a mechanism that the system refuses.
struct Refusal {
  std::string mechanism;  ///< one of kMechanisms
  std::string reason;
};

/// Replaces this process by bubblewrap, which starts `program` again with `arguments`. The new process has no
/// capabilities, and has its own user, process, network, IPC and UTS namespaces. Its file tree contains only system
/// libraries, `sandbox` and an empty /tmp. Open descriptors stay open. Returns only if this fails.
Refusal enter_namespaces(const Sandbox& sandbox, const std::string& program, const std::vector<std::string>& arguments);

/// Restricts the environment and the limits of the calling process, and its access to files (by Landlock).
/// `has_namespaces` must be true if enter_namespaces() has started this process. If it is false, the process can write
/// only into a new folder in `sandbox.folder`. Returns the mechanisms that the system refuses. The process must have
/// only one thread.
std::vector<Refusal> restrict_process(const Sandbox& sandbox, bool has_namespaces);

/// The files and folders that a process may access, by kind of access. Paths that do not exist are ignored.
struct FileAccess {
  std::vector<std::string> reads;            ///< may be read and executed, including all contents of folders
  std::vector<std::string> writes;           ///< full access
  std::vector<std::string> writes_in_place;  ///< may be read and written, but not created, such as /dev/null
};

/// Restricts this process and its children to these files. Restricted processes can send signals and connect abstract
/// sockets only to each other. Returns the reason if the kernel refuses this. Otherwise, returns nullopt.
std::optional<std::string> restrict_files(const FileAccess& access);

/// Prevents this process and its children from accessing the memory and open files of other processes (requires Linux
/// 5.19), and from sending signals to them (requires Linux 6.12). Returns true if signals are prevented, too. Access to
/// files does not change. The process must have only one thread.
bool shield_other_processes();

/// Permits only the system calls that a simulation needs; all others fail with EPERM. If `has_namespaces` is true, the
/// process may also use sockets and change attributes of files, because these are private to it. System calls of
/// another architecture end the process. If the system permits no filter, returns the reason. Otherwise, returns
/// nullopt.
std::optional<std::string> allow_simulation_calls(bool has_namespaces);

}  // namespace mebots::master::isolation
