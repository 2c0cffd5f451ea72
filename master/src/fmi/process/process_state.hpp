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

/// Maps signals to their handlers.
using Handlers = std::map<int, struct sigaction>;

/// Maps open descriptors to the device and inode of their files.
using OpenFiles = std::map<int, std::pair<dev_t, ino_t>>;

/// Returns the open descriptors of this process. Leaves out network connections, because they can end without an FMU's
/// action.
OpenFiles open_files();
/// Returns the descriptors of standard input, output and error.
OpenFiles standard_files();

/// Checks that certain descriptors stay open. Keeps copies of standard input, output and error.
class DescriptorState {
 public:
  /// Checks only those descriptors in `files` that still refer to the same file, because owners may have closed the
  /// others.
  explicit DescriptorState(const OpenFiles& files);
  ~DescriptorState();
  DescriptorState(const DescriptorState&) = delete;
  DescriptorState& operator=(const DescriptorState&) = delete;

  /// Appends a text for each descriptor that was closed or refers to another file. Restores the descriptors of standard
  /// input, output and error.
  void put_right(std::vector<std::string>& texts) const;

 private:
  static constexpr int kStandard = 3;  // standard input, output and error

  OpenFiles files_;
  std::array<int, kStandard> copies_{};  // copies of the standard descriptors; -1 if one was closed
};

/// The properties of the calling thread that an FMU can change: signal mask, alternate signal stack, nice value,
/// scheduling policy, processor affinity and parent-death signal. On Linux, all of them belong to a thread, not to the
/// process.
class ThreadState {
 public:
  /// Reads the state of the calling thread.
  ThreadState();

  /// Appends one text for each difference from the state at construction, and reverts the change if possible. A change
  /// that cannot be reverted is reported only once in the life of the process. Has an effect only on the thread that
  /// called the constructor.
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

/// The timers of this process: the three timers of setitimer(), of which alarm() uses the first, and those created by
/// timer_create(). The kernel lists the latter in /proc/self/timers. If this file is missing, they are not compared.
class TimerState {
 public:
  /// Reads the active timers.
  TimerState();

  /// Appends a text for each timer that was started or stopped since construction. If the timer's signal would end the
  /// process, stops the timer. If the signal has a handler, the FMU may need the timer. In this case, the timer
  /// continues, and the change is reported only once in the life of the process.
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

/// Stops the timer of setitimer() that sends this signal, if the timer is active.
void stop_timers_of(int signal);

/// A copy of the process's environment variables.
class EnvironmentVariables {
 public:
  static EnvironmentVariables now();

  /// Sets the process's environment variables to those of this copy. Returns one text for each difference that it
  /// reverted, such as "environment variable TZ became 'UTC' (put back)".
  std::vector<std::string> restore() const;

 private:
  struct Entry {
    const char* place;  // pointer to the entry in the environment; never dereferenced
    std::string text;   // content of the entry: NAME=value
  };
  std::vector<Entry> entries_;
};

/// The process-wide state that an FMU in this process can change: descriptors, file mode mask, working directory,
/// locale, environment variables, limits, signal handlers, timers, and the state of the calling thread (ThreadState). A
/// change of this state can alter what other FMUs and the master compute or write. Must not be used by two threads at
/// the same time.
class ProcessState {
 public:
  /// Stores those parts of the state that an FMU with this `reach` can change. `files` lists the descriptors that must
  /// stay open.
  explicit ProcessState(const OpenFiles& files = open_files(), ProcessReach reach = ProcessReach::everything);

  /// Reverts changes where possible. Returns one text for each difference, such as "the mask of file modes became 000
  /// (put back to 022)". Restores no descriptors except standard input, output and error. Restores only the handlers of
  /// signals that end a run (SIGINT, SIGTERM, SIGHUP), because the FMU may need its other handlers. A remaining change
  /// is reported only once in the life of the process.
  std::vector<std::string> put_right() const;
  /// Returns true if the calling thread's signal mask has changed. Costs one system call.
  bool is_mask_changed() const { return rest_ && rest_->thread.is_mask_changed(); }

 private:
  static constexpr std::array kLimits = {RLIMIT_AS,    RLIMIT_CORE,   RLIMIT_CPU,  RLIMIT_DATA,
                                         RLIMIT_FSIZE, RLIMIT_NOFILE, RLIMIT_STACK};

  /// Contains everything except descriptors.
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

/// Returns those signal handlers whose code belongs to a loaded library or to the program.
Handlers handlers_in_libraries();

/// Restores the default action of each signal whose handler in `before` was unloaded, and stops the timers that send
/// this signal.
void reset_unloaded_handlers(const Handlers& before);

/// Returns true on the first call with this text in the life of the process, so that a change which cannot be reverted
/// is reported only once. May be called from any thread.
bool is_new_change(std::string text);

}  // namespace mebots::master
