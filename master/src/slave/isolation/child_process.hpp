// SPDX-License-Identifier: Apache-2.0
#pragma once

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

/// A program that is, or becomes, a keeper (keeper.hpp), in a session of its own, so that Ctrl-C in the master's
/// terminal is not for it. Gone with this object, together with all processes that came of it.
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

}  // namespace mebots::master::isolation
