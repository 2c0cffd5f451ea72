// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Creates the sandbox of a host process with several mechanisms (kMechanisms). A system may lack some of them.
namespace mebots::master::isolation {

/// The files that a sandboxed FMU may access.
struct Sandbox {
  std::filesystem::path folder;    ///< folder of the unpacked FMU; read-only
  std::vector<std::string> reads;  ///< other files and folders that the FMU may read
};

/// A mechanism that the system does not provide.
struct Refusal {
  std::string mechanism;  ///< one of kMechanisms
  std::string reason;
};

/// Replaces this process by bubblewrap, which starts `program` with `arguments`. The new process has no capabilities,
/// and has its own user, process, network, IPC and UTS namespaces. Its file tree contains only system libraries, the
/// paths of `sandbox` and an empty /tmp. Open descriptors stay open. Returns only on failure.
Refusal enter_namespaces(const Sandbox& sandbox, const std::string& program, const std::vector<std::string>& arguments);

/// Restricts the environment, the resource limits and the file access of this process. `has_namespaces` is true if
/// enter_namespaces() has started this process. Otherwise, the process can write only into a new folder in
/// `sandbox.folder`. Returns the mechanisms that the system does not provide. The process must have only one thread.
std::vector<Refusal> restrict_process(const Sandbox& sandbox, bool has_namespaces);

/// The files and folders that a process may access. Paths that do not exist are ignored.
struct FileAccess {
  std::vector<std::string> reads;            ///< read and execute, including the contents of folders
  std::vector<std::string> writes;           ///< full access
  std::vector<std::string> writes_in_place;  ///< read and write existing files, such as /dev/null
};

/// Restricts this process and its children to these files. Restricted processes can send signals and connect to
/// abstract sockets only among themselves. If the kernel does not support this, returns the reason; otherwise nullopt.
std::optional<std::string> restrict_files(const FileAccess& access);

/// Prevents this process and its children from accessing the memory and open files of other processes (requires Linux
/// 5.19), and from sending signals to them (requires Linux 6.12). Returns true if it also prevents signals. Does not
/// restrict files. The process must have only one thread.
bool shield_other_processes();

/// Permits only the system calls that a simulation needs; all others fail with EPERM. If `has_namespaces` is true, also
/// permits sockets and changes of file attributes, which are private to the process. System calls of another
/// architecture end the process. If the system does not support such filters, returns the reason; otherwise nullopt.
std::optional<std::string> allow_simulation_calls(bool has_namespaces);

}  // namespace mebots::master::isolation
