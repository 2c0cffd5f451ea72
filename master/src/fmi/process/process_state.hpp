// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/process/process_functions.hpp"

#include <sched.h>
#include <sys/resource.h>
#include <sys/time.h>
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

/// What an FMU can change of the thread that calls it: signal mask, alternate signal stack, nice value, scheduling
/// policy, processor affinity, parent-death signal. On Linux, all of them belong to the thread.
class ThreadState {
 public:
  /// Reads the state of the calling thread.
  ThreadState();

  /// Appends one text for each difference from the state at construction, and undoes what it can. A change that stays
  /// is reported once in the life of the process. No effect on another thread than the one of the constructor.
  void put_right(std::vector<std::string>& texts) const;
  /// Returns true if the signal mask is another: a cheap question.
  bool is_mask_changed() const;

 private:
  void compare_mask(std::vector<std::string>& texts) const;
  void compare_stack(std::vector<std::string>& texts) const;
  void compare_scheduling(std::vector<std::string>& texts) const;
  void compare_death_signal(std::vector<std::string>& texts) const;

  pid_t thread_;
  sigset_t mask_{};
  stack_t stack_{};
  int nice_;
  int policy_;
  sched_param parameters_{};
  cpu_set_t processors_{};
  int death_signal_ = 0;
};

/// The timers of this process: the three of setitimer(), of which alarm() uses the first, and those of timer_create().
/// The kernel lists the latter in /proc/self/timers; if it does not, they are not compared.
class TimerState {
 public:
  /// Reads the timers that run.
  TimerState();

  /// Appends one text for each timer that runs now and did not at construction, or the other way round. If the
  /// timer's signal would end the process, the timer is stopped. If the signal has a handler, the timer may be how the
  /// FMU works: it stays, and is reported once in the life of the process.
  void put_right(std::vector<std::string>& texts) const;

 private:
  static constexpr std::array kInterval = {ITIMER_REAL, ITIMER_VIRTUAL, ITIMER_PROF};
  /// By the kernel's number: the signal of each timer.
  using Created = std::map<int, int>;

  static Created created();
  void compare_intervals(std::vector<std::string>& texts) const;
  void compare_created(std::vector<std::string>& texts) const;

  std::array<itimerval, kInterval.size()> intervals_{};
  Created created_;
};

/// Stops the timer of setitimer() that sends this signal, if there is one.
void stop_timers_of(int signal);

/// A copy of the process's environment variables.
class EnvironmentVariables {
 public:
  static EnvironmentVariables now();

  /// Sets the process's variables to those of this copy. Returns one text per difference that it undid:
  /// "environment variable TZ became 'UTC' (put back)". Costs a comparison if nothing differs.
  std::vector<std::string> restore() const;

 private:
  struct Entry {
    const char* place;  // in the environment; never read
    std::string text;   // NAME=value
  };
  std::vector<Entry> entries_;
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
