// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/process/environment_variables.hpp"
#include "fmi/process/process_functions.hpp"
#include "fmi/process/thread_state.hpp"
#include "fmi/process/timer_state.hpp"

#include <sys/resource.h>
#include <sys/types.h>

#include <array>
#include <csignal>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master {

/// By signal.
using Handlers = std::map<int, struct sigaction>;

/// Open descriptors, and the file that each leads to.
using OpenFiles = std::map<int, std::pair<dev_t, ino_t>>;

/// Returns the open descriptors of this process, without connections of the network, which end without an FMU.
OpenFiles open_files();
/// Returns those of input, output and errors.
OpenFiles standard_files();

/// Descriptors that must stay open. Keeps a copy of the standard three.
class DescriptorState {
 public:
  /// Watches the descriptors in `files` that still lead to the same file; others may be closed by their owners.
  explicit DescriptorState(const OpenFiles& files);
  ~DescriptorState();
  DescriptorState(const DescriptorState&) = delete;
  DescriptorState& operator=(const DescriptorState&) = delete;

  /// Appends one text for each descriptor that is closed or leads to another file. Puts back the standard three.
  void put_right(std::vector<std::string>& texts) const;

 private:
  static constexpr int kStandard = 3;  // descriptors of input, output and errors

  OpenFiles files_;
  std::array<int, kStandard> copies_{};  // of the standard descriptors; -1 where there is none
};

/// What an FMU in this process can change for all code in it: descriptors, mask of file modes, working directory,
/// locale, environment variables, limits, signal handlers, timers; and for the calling thread, see ThreadState. Such a
/// change alters what the other FMUs and the master compute or write. Not for use by two threads at once.
class ProcessState {
 public:
  /// Reads the state, as far as `reach` says that it can change. Of the open descriptors, see DescriptorState.
  explicit ProcessState(const OpenFiles& files = open_files(), ProcessReach reach = ProcessReach::everything);

  /// Returns one text for each difference: "the mask of file modes became 000 (put back to 022)". Puts back what it
  /// can. Descriptors stay, except the standard three. Signal handlers stay, since the FMU may need them, except those
  /// that end a run (SIGINT, SIGTERM, SIGHUP). A change that stays is reported once in the life of the process.
  std::vector<std::string> put_right() const;
  /// Returns true if the calling thread blocks other signals. Costs one system call.
  bool is_mask_changed() const { return rest_ && rest_->thread.is_mask_changed(); }

 private:
  static constexpr std::array kLimits = {RLIMIT_AS,    RLIMIT_CORE,   RLIMIT_CPU,  RLIMIT_DATA,
                                         RLIMIT_FSIZE, RLIMIT_NOFILE, RLIMIT_STACK};

  /// Everything but descriptors.
  struct Rest {
    Rest();
    void put_right(std::vector<std::string>& texts) const;
    void compare_limits(std::vector<std::string>& texts) const;
    void compare_handlers(std::vector<std::string>& texts) const;

    mode_t umask;
    std::string folder;
    std::string locale;
    EnvironmentVariables environment;
    std::array<rlimit, kLimits.size()> limits{};
    Handlers handlers;
    TimerState timers;
    ThreadState thread;
  };

  DescriptorState descriptors_;
  std::optional<Rest> rest_;
};

/// Returns the signal handlers that are code of a loaded library or of the program.
Handlers handlers_in_libraries();

/// If the code of a handler among `before` was unloaded since: its signal gets the default action again, and the timers
/// that send it stop.
void reset_unloaded_handlers(const Handlers& before);

/// Returns true for the first call with this text in the life of the process: a change that stays is reported once.
/// From any thread.
bool is_new_change(std::string text);

}  // namespace mebots::master
