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

using Handlers = std::map<int, struct sigaction>;

/// The device and inode of each open file descriptor.
using OpenFiles = std::map<int, std::pair<dev_t, ino_t>>;

/// Returns the open file descriptors of this process. Omits network connections, because their peers can close them at
/// any time.
OpenFiles open_files();
OpenFiles standard_files();

/// Detects closed file descriptors. Keeps copies of standard input, output and error.
class DescriptorState {
 public:
  /// Observes the descriptors in `files`. Ignores those that no longer refer to the same file, because their owners may
  /// have closed them.
  explicit DescriptorState(const OpenFiles& files);
  ~DescriptorState();
  DescriptorState(const DescriptorState&) = delete;
  DescriptorState& operator=(const DescriptorState&) = delete;

  /// Appends a text for each descriptor that was closed or refers to another file. Restores standard input, output and
  /// error.
  void put_right(std::vector<std::string>& texts) const;

 private:
  static constexpr int kStandard = 3;

  OpenFiles files_;
  std::array<int, kStandard> copies_{};  // of the standard descriptors; -1 if a descriptor was closed
};

/// The properties of the calling thread that an FMU can change: signal mask, alternate signal stack, nice value,
/// scheduling policy, processor affinity and parent-death signal. On Linux, each thread has its own.
class ThreadState {
 public:
  /// Reads the state of the calling thread.
  ThreadState();

  /// Appends a text for each change since construction, and reverts the change if possible. If it is not possible,
  /// reports the change only once in the life of the process. Has no effect on another thread than that of the
  /// constructor.
  void put_right(std::vector<std::string>& texts) const;
  /// True if the signal mask of the thread has changed since construction. This check is cheap.
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

/// The timers of this process: the three timers of setitimer(), the first of which alarm() also uses, and those of
/// timer_create(). The latter are read from /proc/self/timers. If this file does not exist, they are not compared.
class TimerState {
 public:
  TimerState();

  /// Appends a text for each timer that was started or stopped since construction. Stops a timer whose signal would end
  /// the process. A timer whose signal has a handler continues, because the FMU may need it. Its text is then appended
  /// only once in the life of the process.
  void put_right(std::vector<std::string>& texts) const;

 private:
  static constexpr std::array kInterval = {ITIMER_REAL, ITIMER_VIRTUAL, ITIMER_PROF};
  /// The signal of each timer; the key is the kernel's id of the timer.
  using Created = std::map<int, int>;

  static Created created();
  void compare_intervals(std::vector<std::string>& texts) const;
  void compare_created(std::vector<std::string>& texts) const;

  std::array<itimerval, kInterval.size()> intervals_{};
  Created created_;
};

/// Stops the active timer of setitimer() that sends this signal.
void stop_timers_of(int signal);

class EnvironmentVariables {
 public:
  static EnvironmentVariables now();

  /// Restores the environment variables that this object contains. Returns a text for each reverted change, such as
  /// "environment variable TZ became 'UTC' (put back)".
  std::vector<std::string> restore() const;

 private:
  struct Entry {
    const char* place;  // pointer to the entry in the environment; must not be dereferenced
    std::string text;   // NAME=value
  };
  std::vector<Entry> entries_;
};

/// The process-wide state that an FMU in this process can change: file descriptors, file mode mask, working directory,
/// locale, environment variables, limits, signal handlers, timers, and the state of the calling thread. Such a change
/// can affect other FMUs and the master. Must not be used by two threads at the same time.
class ProcessState {
 public:
  /// Stores the current state. If `reach` is not ProcessReach::everything, stores only the file descriptors. The
  /// descriptors in `files` must stay open.
  explicit ProcessState(const OpenFiles& files = open_files(), ProcessReach reach = ProcessReach::everything);

  /// Reverts changes if possible, and returns a text for each change, such as "the mask of file modes became 000 (put
  /// back to 022)". Of the descriptors, restores only standard input, output and error. Of the signal handlers,
  /// restores only those of SIGINT, SIGTERM and SIGHUP, because the FMU may need the others. Reports a change that it
  /// does not revert only once in the life of the process.
  std::vector<std::string> put_right() const;
  /// True if the signal mask of the calling thread has changed. Needs one system call.
  bool is_mask_changed() const { return rest_ && rest_->thread.is_mask_changed(); }

 private:
  static constexpr std::array kLimits = {RLIMIT_AS,    RLIMIT_CORE,   RLIMIT_CPU,  RLIMIT_DATA,
                                         RLIMIT_FSIZE, RLIMIT_NOFILE, RLIMIT_STACK};

  /// All parts of the state except the file descriptors.
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

/// Returns the signal handlers whose code is in a loaded library or in the program.
Handlers handlers_in_libraries();

/// Restores the default action of each signal whose handler in `before` was unloaded. Stops the timers of this signal.
void reset_unloaded_handlers(const Handlers& before);

/// Returns true on the first call with this text in the life of the process. May be called from any thread.
bool is_new_change(std::string text);

}  // namespace mebots::master
