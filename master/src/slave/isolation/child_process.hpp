// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"

#include <sys/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace mebots::master::isolation {

/// Describes how a process ended.
struct ProcessEnd {
  bool by_signal = false;
  int number = 0;                   ///< signal number or exit code
  std::int64_t peak_memory_kb = 0;  ///< peak resident memory of the process
};

/// A child process whose program must call fork_kept(). The process has its own session, so that Ctrl-C in the master's
/// terminal does not affect it. The destructor ends the process and all its descendants.
class ChildProcess {
 public:
  /// Starts the program. Its standard input is empty, `descriptors` become its descriptors 3, 4 and so on, and it has
  /// no other open files. Throws Error if the program cannot be started.
  ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
               const std::array<int, 4>& descriptors);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Returns how the process ended. Returns nullopt if the process is still running.
  std::optional<ProcessEnd> ended();
  /// Waits at most `seconds` for the end of the process. Returns how it ended. Returns nullopt if it is still running.
  std::optional<ProcessEnd> ended_within(double seconds);
  /// Ends the process and all its descendants, and waits until they have ended.
  void kill();

 private:
  pid_t pid_ = -1;
  std::optional<ProcessEnd> end_;
};

/// Raises the limit of open files (RLIMIT_NOFILE) if `count` isolated instances need a higher limit. Each instance
/// needs `each` descriptors of this process. If the hard limit is too low, throws Error that states the needed number.
void reserve_descriptors(std::size_t count, std::size_t each);

/// Returns a text such as "signal 11 (SIGSEGV, invalid memory access)".
std::string signal_text(int signal);

/// Returns the path of the program `mebots-fmu-host`. Searches $MEBOTS_FMU_HOST, the folder of the running program, the
/// folder of this library, and the library's ../bin. If the program is not found, throws Error with the searched paths.
std::filesystem::path find_fmu_host();

/// Forks. Returns only in the child, which leads a new session. The calling process becomes the keeper of the child.
/// When the child or `parent` ends (by any signal), or at end_kept(), the keeper ends all descendants of the child, in
/// any process group or session. After that, the keeper ends in the same way as the child. If the keeper ends, the
/// child ends, too. Neither of them writes a core dump. The process must have only one thread. Throws Error if no
/// process can be created.
void fork_kept(pid_t parent);

/// Requests a keeper (see fork_kept()) to end its descendants and itself, and waits until the keeper has ended. Does
/// not reap the keeper.
void end_kept(pid_t keeper);

}  // namespace mebots::master::isolation

namespace mebots::master {

/// Determines from the ELF files of an FMU whether it needs a Python interpreter. If so, chooses the Python of
/// MEBOTS_PYTHON, otherwise `python3` on PATH. If neither has a shared library, chooses the newest one in the system's
/// folders. If no library is needed or found, `library` is empty.
Interpreter interpreter_of(const Fmu& fmu);

/// The main function of `mebots-fmu-host`. Runs one FMU for the master that started the program, until the master
/// closes the connection. `words` contains the program, the master's process number and the memory limit in bytes. For
/// a sandbox, more words follow: `--sandbox FOLDER`, `--reads PATH` for each additional readable path, and `--may-lack
/// MECHANISM` for each optional mechanism. `--inside` means that the program was started a second time, inside the
/// namespaces. Returns the exit code.
int run_fmu_host(int argument_count, char** words);

}  // namespace mebots::master
