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

struct ProcessEnd {
  bool by_signal = false;
  int number = 0;                   ///< signal number or exit code
  std::int64_t peak_memory_kb = 0;  ///< peak resident memory
};

/// A child process whose program must call fork_kept(). The process has its own session, so that Ctrl-C in the terminal
/// does not affect it. The destructor ends the process and all its descendants.
class ChildProcess {
 public:
  /// Starts the program with empty standard input. `descriptors` become the file descriptors 3, 4 and so on. The
  /// program has no other open files. Throws Error if the program cannot be started.
  ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
               const std::array<int, 4>& descriptors);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Returns how the process ended; nullopt if it is running.
  std::optional<ProcessEnd> ended();
  /// Waits for the end of the process for at most `seconds`. Returns how it ended; nullopt if it is still running.
  std::optional<ProcessEnd> ended_within(double seconds);
  /// Ends the process and all its descendants, and waits for their end.
  void kill();

 private:
  pid_t pid_ = -1;
  std::optional<ProcessEnd> end_;
};

/// Raises the limit of open files (RLIMIT_NOFILE) if necessary. `count` isolated instances need `each` descriptors of
/// this process. Throws Error with the needed number if the hard limit is too low.
void reserve_descriptors(std::size_t count, std::size_t each);

/// Describes a signal, such as "signal 11 (SIGSEGV, invalid memory access)".
std::string signal_text(int signal);

/// Finds the program `mebots-fmu-host`. Searches $MEBOTS_FMU_HOST, the folder of the running program, the folder of
/// this library, and the library's ../bin. Throws Error with the searched paths if the program is not found.
std::filesystem::path find_fmu_host();

/// Forks, and returns only in the child, which leads a new session. The calling process becomes the keeper of the
/// child. The keeper ends all descendants of the child when the child or the process `parent` ends, or when end_kept()
/// is called. It then ends in the same way as the child. If the keeper ends, the child also ends. Neither process
/// writes a core dump. The calling process must have only one thread. Throws Error if fork() fails.
void fork_kept(pid_t parent);

/// Requests a keeper (see fork_kept()) to end its descendants and itself. Waits for the end of the keeper, but does not
/// reap it.
void end_kept(pid_t keeper);

}  // namespace mebots::master::isolation

namespace mebots::master {

/// Determines whether the library of an FMU needs a Python interpreter, and finds this interpreter. Uses MEBOTS_PYTHON
/// or, if it is not set, `python3` on PATH. If neither has a shared library, uses the newest one in the system's
/// folders. `library` is empty if no library is needed or found.
Interpreter interpreter_of(const Fmu& fmu);

/// The main function of `mebots-fmu-host`. Executes the calls for one FMU until the master closes the connection.
/// `words` contains the program, the process id of the master and the memory limit in bytes. For a sandbox, `--sandbox
/// FOLDER`, `--reads PATH` and `--may-lack MECHANISM` follow. `--inside` means that the program was started again
/// inside the namespaces. Returns the exit code.
int run_fmu_host(int argument_count, char** words);

}  // namespace mebots::master
