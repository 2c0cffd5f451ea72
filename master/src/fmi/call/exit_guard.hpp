// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>

namespace mebots::master {

/// Makes a run fail properly if an FMU ends the process: by exit(), by the signal of a timer, or by ending a thread. If
/// the run is busy (see the constructor), the guard calls `fail` with a reason that names the instance and the call.
/// `fail` writes the results and the summary. The process then exits with code 1. The C library calls handlers at
/// exit() and quick_exit(), but not at _exit() and exec(). Programs of MEbots therefore replace _exit() and exec()
/// (app/own_exit.cpp). The guard has no effect in processes that an FMU forks, or if the kernel ends the process.
class ExitGuard {
 public:
  using Fail = std::function<void(const std::string& what)>;

  /// `busy` must outlive the guard. It must be true during each step of the run.
  ExitGuard(const bool& busy, Fail fail);
  ~ExitGuard();
  ExitGuard(const ExitGuard&) = delete;
  ExitGuard& operator=(const ExitGuard&) = delete;

  /// True if `busy` of the constructor is true, and this process created the guard. Used by exit handlers.
  bool busy() const;
  void fail(const std::string& what) const { fail_(what); }

 private:
  const bool* busy_;
  pid_t process_;
  Fail fail_;
};

/// Must be called by the thread that is ending this process. If an ExitGuard is busy, calls `fail` of each busy guard
/// and ends the process. Returns only if no guard is busy. `what` describes the action of the FMU in the past tense,
/// such as "called exit()".
void end_busy_runs(const char* what);

/// Handles a signal from a timer or from this process that would end the process. During a call to an FMU, calls
/// end_busy_runs(). Otherwise, stores the signal for take_kept_signal(), so that the work of the master is not
/// interrupted. Returns false if no ExitGuard is busy.
bool end_by_signal(int signal);

/// Describes the signal that end_by_signal() has stored since the last call; nullopt if it has stored no signal. The
/// stepping thread must call this function between two calls to FMUs.
std::optional<std::string> take_kept_signal();

/// Installs handlers for SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP and SIGSYS. They report a crash on standard
/// error, and then the default action of the signal follows. If the crash occurred in a call to an FMU, the report
/// contains instance, call and time. Also installs handlers for signals that timers and this process may send, such as
/// SIGALRM. If a timer or this process has sent such a signal, its handler calls end_by_signal(). Does not replace
/// existing handlers. Installs no handler for SIGALRM if the embedding program has a timer. Must be called once, from
/// any thread.
void install_crash_notice();

/// True if the signal ends the process: it has no handler, or only that of install_crash_notice().
bool ends_process(int signal);

/// Returns the name of a signal, such as "SIGALRM", or its number, such as "signal 40".
std::string signal_name(int signal);

}  // namespace mebots::master
