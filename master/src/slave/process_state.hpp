// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slave/environment_variables.hpp"
#include "slave/thread_state.hpp"
#include "slave/timer_state.hpp"

#include <sys/resource.h>
#include <sys/types.h>

#include <array>
#include <csignal>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master {

/// By signal.
using Handlers = std::map<int, struct sigaction>;

/// What an FMU in this process can change for everybody: mask of file modes, working directory, locale, environment
/// variables, limits, open descriptors, signal handlers, timers; and for the calling thread, see ThreadState. Whoever
/// changes one of them changes what the other FMUs and the master compute or write. Not for use by two threads at once.
class ProcessState {
 public:
  /// Open descriptors, and the file that each leads to. Without connections of the network, which end without an FMU.
  using Files = std::map<int, std::pair<dev_t, ino_t>>;

  /// As it stands. Of the open descriptors those in `files` that still lead there; others may be closed by whoever
  /// opened them.
  explicit ProcessState(const Files& files = open_files());
  ~ProcessState();
  ProcessState(const ProcessState&) = delete;
  ProcessState& operator=(const ProcessState&) = delete;

  /// Returns what is different now, one text each: "the mask of file modes became 000 (put back to 022)". Puts back
  /// what it can. Descriptors stay, except the standard three. Signal handlers stay, since the FMU may need them,
  /// except those that end a run (SIGINT, SIGTERM, SIGHUP). What stays is reported once in the life of the process.
  std::vector<std::string> put_right() const;
  /// Returns true if the calling thread blocks other signals: a cheap question.
  bool is_mask_changed() const { return thread_.is_mask_changed(); }

  static Files open_files();
  /// Those of input, output and errors.
  static Files standard_files();

 private:
  static constexpr int kStandard = 3;  // descriptors of input, output and errors
  static constexpr std::array kLimits = {RLIMIT_AS,    RLIMIT_CORE,   RLIMIT_CPU,  RLIMIT_DATA,
                                         RLIMIT_FSIZE, RLIMIT_NOFILE, RLIMIT_STACK};

  void compare_files(std::vector<std::string>& texts) const;
  void compare_limits(std::vector<std::string>& texts) const;
  void compare_handlers(std::vector<std::string>& texts) const;

  mode_t umask_;
  std::string folder_;
  std::string locale_;
  EnvironmentVariables environment_;
  std::array<rlimit, kLimits.size()> limits_{};
  Files files_;
  std::array<int, kStandard> copies_{};  // of the standard descriptors; -1 where there is none
  Handlers handlers_;
  TimerState timers_;
  ThreadState thread_;
};

/// Returns the signal handlers that are code of a loaded library or of the program.
Handlers handlers_in_libraries();

/// If the code of a handler among `before` was unloaded since: its signal gets the default action again, and the timers
/// that send it stop.
void reset_unloaded_handlers(const Handlers& before);

/// Returns true for the first call with this text in the life of the process: a change that stays is reported once.
/// From any thread.
bool is_new_change(std::string text);

/// "SIGALRM"; "signal 40" if it has no name.
std::string signal_name(int signal);

}  // namespace mebots::master
