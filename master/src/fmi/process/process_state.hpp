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

/// Open descriptors with device and inode of their files.
using OpenFiles = std::map<int, std::pair<dev_t, ino_t>>;

/// Returns the open descriptors of this process. Leaves out network connections, because they can end without an FMU's
/// action.
OpenFiles open_files();
/// Returns the descriptors of standard input, output and error.
OpenFiles standard_files();

/// Descriptors that must stay open. Keeps copies of standard input, output and error.
class DescriptorState {
 public:
  /// Watches the descriptors in `files` that still refer to the same file; the others may have been closed by their
  /// owners.
  explicit DescriptorState(const OpenFiles& files);
  ~DescriptorState();
  DescriptorState(const DescriptorState&) = delete;
  DescriptorState& operator=(const DescriptorState&) = delete;

  /// Appends a text for each descriptor that is closed or refers to another file. Restores the descriptors of standard
  /// input, output and error.
  void put_right(std::vector<std::string>& texts) const;

 private:
  static constexpr int kStandard = 3;  // standard input, output and error

  OpenFiles files_;
  std::array<int, kStandard> copies_{};  // of the standard descriptors; -1 if closed
};

/// The properties of the calling thread that an FMU can change: signal mask, alternate signal stack, nice value,
/// scheduling policy, processor affinity, parent-death signal. On Linux, all of them belong to the thread.
class ThreadState {
 public:
  /// Reads the state of the calling thread.
  ThreadState();

  /// Appends one text for each difference from the state at construction, and undoes the change if possible. A change
  /// that cannot be undone is reported once in the life of the process. Has an effect only on the thread that called
  /// the constructor.
  void put_right(std::vector<std::string>& texts) const;
  /// True if the thread's signal mask has changed since construction. This check is cheap.
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

/// The timers of this process: the three timers of setitimer(), of which alarm() uses the first, and the timers of
/// timer_create(). The kernel lists the timers of timer_create() in /proc/self/timers. If this file is missing, they
/// are not compared.
class TimerState {
 public:
  /// Reads the active timers.
  TimerState();

  /// Appends a text for each timer that was started or stopped since construction. If the timer's signal would end the
  /// process, stops the timer. If the signal has a handler, the FMU may need the timer. In this case the timer
  /// continues, and is reported once in the life of the process.
  void put_right(std::vector<std::string>& texts) const;

 private:
  static constexpr std::array kInterval = {ITIMER_REAL, ITIMER_VIRTUAL, ITIMER_PROF};
  /// Maps the kernel's number of each timer to the timer's signal.
  using Created = std::map<int, int>;

  static Created created();
  void compare_intervals(std::vector<std::string>& texts) const;
  void compare_created(std::vector<std::string>& texts) const;

  std::array<itimerval, kInterval.size()> intervals_{};
  Created created_;
};

/// Stops the timer of setitimer() that sends this signal, if that timer runs.
void stop_timers_of(int signal);

/// A copy of the process's environment variables.
class EnvironmentVariables {
 public:
  static EnvironmentVariables now();

  /// Sets the process's environment variables to those of this copy. Returns one text per difference that it undid,
  /// such as "environment variable TZ became 'UTC' (put back)". If nothing differs, only compares the variables.
  std::vector<std::string> restore() const;

 private:
  struct Entry {
    const char* place;  // in the environment; never read
    std::string text;   // NAME=value
  };
  std::vector<Entry> entries_;
};

/// The process-wide state that an FMU in this process can change: descriptors, file mode mask, working directory,
/// locale, environment variables, limits, signal handlers, timers, and the state of the calling thread (ThreadState). A
/// change of this state can alter what the other FMUs and the master compute or write. Not for use by two threads at
/// once.
class ProcessState {
 public:
  /// Reads the parts of the state that an FMU with this `reach` can change. DescriptorState describes the open
  /// descriptors.
  explicit ProcessState(const OpenFiles& files = open_files(), ProcessReach reach = ProcessReach::everything);

  /// Undoes changes where possible. Returns one text per difference, such as "the mask of file modes became 000 (put
  /// back to 022)". Of the descriptors, restores only standard input, output and error. Of the signal handlers,
  /// restores only those of signals that end a run (SIGINT, SIGTERM, SIGHUP), because the FMU may need its other
  /// handlers. A remaining change is reported once in the life of the process.
  std::vector<std::string> put_right() const;
  /// Returns true if the calling thread's signal mask has changed. Costs one system call.
  bool is_mask_changed() const { return rest_ && rest_->thread.is_mask_changed(); }

 private:
  static constexpr std::array kLimits = {RLIMIT_AS,    RLIMIT_CORE,   RLIMIT_CPU,  RLIMIT_DATA,
                                         RLIMIT_FSIZE, RLIMIT_NOFILE, RLIMIT_STACK};

  /// Everything except descriptors.
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

/// If the code of a handler in `before` has been unloaded, restores the default action of its signal, and stops the
/// timers that send this signal.
void reset_unloaded_handlers(const Handlers& before);

/// Returns true for the first call with this text in the life of the process, so that a change that cannot be undone is
/// reported only once. May be called from any thread.
bool is_new_change(std::string text);

}  // namespace mebots::master
