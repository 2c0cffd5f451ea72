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

/// How a process ended.
struct ProcessEnd {
  bool by_signal = false;
  int number = 0;                   ///< of the signal, or the exit code
  std::int64_t peak_memory_kb = 0;  ///< largest resident set
};

/// A program that calls fork_kept(). It has its own session, so that Ctrl-C in the master's terminal does not reach it.
/// The destructor ends it with all its descendants.
class ChildProcess {
 public:
  /// Starts the program: standard input empty, `descriptors` as 3, 4, ... and no other open files.
  /// Throws Error when it cannot be started.
  ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
               const std::array<int, 4>& descriptors);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// How it ended, if it has.
  std::optional<ProcessEnd> ended();
  /// Waits for its end so long [s].
  std::optional<ProcessEnd> ended_within(double seconds);
  /// Ends it and all that came of it, and waits for that.
  void kill();

 private:
  pid_t pid_ = -1;
  std::optional<ProcessEnd> end_;
};

/// Raises the limit of open files (RLIMIT_NOFILE) if `count` isolated instances, of `each` descriptors in this process,
/// need it. Throws Error with the number that they need if the hard limit is lower.
void reserve_descriptors(std::size_t count, std::size_t each);

/// "signal 11 (SIGSEGV, invalid memory access)"
std::string signal_text(int signal);

/// The program `mebots-fmu-host`: in $MEBOTS_FMU_HOST, beside the running program, beside this library, or in
/// ../bin of it. Throws Error that says where it was looked for.
std::filesystem::path find_fmu_host();

/// Forks, and returns in the child, which leads a session of its own. The calling process stays as its keeper. When the
/// child ends, when `parent` does (by whatever signal), or when end_kept() asks for it, the keeper ends every process
/// that came of the child, whatever group or session it went to. Then it ends itself as the child ended. The child ends
/// with its keeper, too; neither dumps core. One thread only. Throws Error when there is no process to be had.
void fork_kept(pid_t parent);

/// Makes a keeper end its processes and itself, and waits for that. Does not reap it.
void end_kept(pid_t keeper);

}  // namespace mebots::master::isolation

namespace mebots::master {

/// Reads the FMU's ELF files. The Python is that of MEBOTS_PYTHON, else `python3` on PATH, else any in the system's
/// folders. If no Python is found, `library` stays empty.
Interpreter interpreter_of(const Fmu& fmu);

/// The main function of `mebots-fmu-host`: runs one FMU for the master that started the program, until the master
/// closes the connection. `words`: the program, the master's process number, the memory limit in bytes. For a sandbox
/// also
/// `--sandbox FOLDER`, `--reads PATH` for each further readable place, `--may-lack MECHANISM` for each mechanism that
/// may be absent, and `--inside` once the namespaces have been entered. Returns the exit code.
int run_fmu_host(int argument_count, char** words);

}  // namespace mebots::master
