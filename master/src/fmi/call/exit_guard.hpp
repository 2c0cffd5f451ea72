// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>

namespace mebots::master {

/// Foreign code can end the process during a run, with any exit code: by exit(), by a timer's signal, or by ending a
/// thread. While a guard exists and its run is busy, such an end is a failure of the run. The function `fail` gets the
/// reason with instance and call, and writes results and summary. Then the process exits with code 1. The C library
/// calls a handler at exit() and quick_exit(), but not at _exit() and exec(). Therefore a program replaces these two
/// functions (app/own_exit.cpp). Processes forked by an FMU are not guarded. If the kernel ends the process, only a
/// separate process for the instance protects the run.
class ExitGuard {
 public:
  using Fail = std::function<void(const std::string& what)>;

  /// `busy` is true while the run is in a step. The variable `busy` must outlive the guard.
  ExitGuard(const bool& busy, Fail fail);
  ~ExitGuard();
  ExitGuard(const ExitGuard&) = delete;
  ExitGuard& operator=(const ExitGuard&) = delete;

  /// True if the run is busy. For handlers that run when the process ends.
  bool busy() const;
  void fail(const std::string& what) const { fail_(what); }

 private:
  const bool* busy_;
  pid_t process_;
  Fail fail_;
};

/// Must be called on the thread that is about to end this process. If a run is busy, the run fails, and this function
/// does not return. `what` describes the FMU's action in the past tense, such as "called exit()".
void end_busy_runs(const char* what);

/// Called by the handler of a signal that would end this process, if the signal comes from a timer or from the process
/// itself. During a call to an FMU, has the effect of end_busy_runs(). Outside of calls, keeps the signal for
/// take_kept_signal(), so that the master's work is not interrupted. Returns false if no run is busy.
bool end_by_signal(int signal);

/// If end_by_signal() kept a signal since the last call, describes it. The thread that steps calls this function
/// between two calls to FMUs.
std::optional<std::string> take_kept_signal();

/// Installs handlers that report a crash inside an FMU on standard error, with instance, call and time, before the
/// signal's default action: SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS. If the signal comes from a timer
/// or from the process itself, the busy runs fail (see end_by_signal()). A signal that already has a handler keeps this
/// handler. SIGALRM gets no handler while the embedding program has a timer. Must be called once, from any thread.
void install_crash_notice();

/// Returns true if the signal would end the process: its only handler is that of install_crash_notice().
bool ends_process(int signal);

/// Returns the name of a signal, such as "SIGALRM"; "signal 40" if it has no name.
std::string signal_name(int signal);

}  // namespace mebots::master
