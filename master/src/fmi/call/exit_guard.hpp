// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>

namespace mebots::master {

/// Protects a run from foreign code that ends the process: by exit(), by a timer's signal, or by ending a thread. While
/// a guard exists and its run is busy, such an end is a failure of the run. The guard calls `fail` with the reason,
/// which names instance and call. `fail` writes the results and the summary. After that, the process exits with code 1.
/// The C library calls a handler at exit() and quick_exit(), but not at _exit() and exec(). Therefore programs of
/// MEbots replace these two functions (app/own_exit.cpp). Processes that an FMU forks are not guarded. If the kernel
/// ends the process, results survive only if the instance runs in a separate process.
class ExitGuard {
 public:
  using Fail = std::function<void(const std::string& what)>;

  /// `busy` must be true while the run is in a step, and must outlive the guard.
  ExitGuard(const bool& busy, Fail fail);
  ~ExitGuard();
  ExitGuard(const ExitGuard&) = delete;
  ExitGuard& operator=(const ExitGuard&) = delete;

  /// True if the run is busy. Called by handlers that run when the process ends.
  bool busy() const;
  void fail(const std::string& what) const { fail_(what); }

 private:
  const bool* busy_;
  pid_t process_;
  Fail fail_;
};

/// Must be called on the thread that is about to end this process. If a run is busy, makes the run fail and ends the
/// process. Otherwise returns. `what` describes the action of the FMU in the past tense, such as "called exit()".
void end_busy_runs(const char* what);

/// Handles a signal that would end this process and that a timer or the process itself has sent. Called by the signal
/// handler. During a call to an FMU, calls end_busy_runs(). Outside of such calls, stores the signal for
/// take_kept_signal(), so that the master's work is not interrupted. Returns false if no run is busy.
bool end_by_signal(int signal);

/// Returns a description of the signal that end_by_signal() has stored since the last call. Returns nullopt if there is
/// none. The thread that steps calls this function between two calls to FMUs.
std::optional<std::string> take_kept_signal();

/// Installs a handler for SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP and SIGSYS. It reports a crash on standard
/// error, inside an FMU with instance, call and time. After that, the signal's default action follows. Also installs a
/// handler for signals that timers and the process itself may send, such as SIGALRM: if one of them has sent the
/// signal, the busy runs fail (see end_by_signal()). Existing handlers are not replaced. SIGALRM receives no handler if
/// the embedding program has a timer. Must be called once, from any thread.
void install_crash_notice();

/// Returns true if the signal would end the process, because it has no handler except that of install_crash_notice().
bool ends_process(int signal);

/// Returns the name of a signal, such as "SIGALRM". Returns a text such as "signal 40" if the signal has no name.
std::string signal_name(int signal);

}  // namespace mebots::master
