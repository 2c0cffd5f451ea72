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
  std::int64_t peak_memory_kb = 0;  ///< largest resident set
};

/// A child process whose program calls fork_kept(). It has its own session, so that Ctrl-C in the master's terminal
/// does not affect it. The destructor ends the process and all its descendants.
class ChildProcess {
 public:
  /// Starts the program with empty standard input, `descriptors` as descriptors 3, 4, ... and no other open files.
  /// Throws Error if the program cannot be started.
  ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
               const std::array<int, 4>& descriptors);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// If the process has ended, returns how it ended.
  std::optional<ProcessEnd> ended();
  /// Waits at most `seconds` for the process to end. Returns how it ended; empty if it still runs.
  std::optional<ProcessEnd> ended_within(double seconds);
  /// Ends the process and all its descendants, and waits for them.
  void kill();

 private:
  pid_t pid_ = -1;
  std::optional<ProcessEnd> end_;
};

/// Raises the limit of open files (RLIMIT_NOFILE) if `count` isolated instances need a higher limit. Each instance
/// takes `each` descriptors of this process. If the hard limit is lower than the needed number, throws Error with this
/// number.
void reserve_descriptors(std::size_t count, std::size_t each);

/// Returns a text such as "signal 11 (SIGSEGV, invalid memory access)".
std::string signal_text(int signal);

/// Finds the program `mebots-fmu-host`: in $MEBOTS_FMU_HOST, in the folder of the running program or of this library,
/// or in the library's ../bin. If the program is not found, throws Error with the searched paths.
std::filesystem::path find_fmu_host();

/// Forks and returns in the child, which leads a new session. The calling process becomes its keeper. When the child
/// ends, when `parent` ends (by any signal), or at end_kept(), the keeper ends all descendants of the child, in any
/// process group or session. The keeper then ends in the same way as the child. If the keeper ends, the child ends,
/// too. Neither the child nor the keeper writes a core dump. The process must have one thread only. Throws Error if no
/// process can be created.
void fork_kept(pid_t parent);

/// Requests a keeper (see fork_kept()) to end its descendants and itself, and waits for the keeper's end. Does not reap
/// the keeper.
void end_kept(pid_t keeper);

}  // namespace mebots::master::isolation

namespace mebots::master {

/// Returns whether the FMU needs a Python interpreter, according to its ELF files, and which one. Chooses the Python of
/// MEBOTS_PYTHON, else `python3` on PATH. If neither has a shared library, chooses the newest one in the system's
/// folders. If no library is needed or found, `library` is empty.
Interpreter interpreter_of(const Fmu& fmu);

/// The main function of `mebots-fmu-host`: runs one FMU for the master that started the program, until the master
/// closes the connection. `words` are the program, the master's process number and the memory limit in bytes. For a
/// sandbox, further words follow: `--sandbox FOLDER`, `--reads PATH` for each further readable path, and `--may-lack
/// MECHANISM` for each optional mechanism. `--inside` marks the second start of the program, inside the namespaces.
/// Returns the exit code.
int run_fmu_host(int argument_count, char** words);

}  // namespace mebots::master
