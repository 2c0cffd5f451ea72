// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>

namespace mebots::master {

/// Foreign code can end the process in the middle of a run, with any exit code: by exit(), by a signal of a timer, by
/// the end of a thread. While a guard lives and its run is busy, such an end is a failure of the run. `fail` receives
/// the reason, with instance and call, and writes results and summary. The process ends with code 1. The C library
/// reports exit() and quick_exit(), but neither _exit() nor exec(): for these a program has functions of its own
/// (app/own_exit.cpp). Processes that an FMU forks end as they like. Against an end by the kernel there is only a
/// process of its own for the instance.
class ExitGuard {
 public:
  using Fail = std::function<void(const std::string& what)>;

  /// `busy` is true while the run is in a step; it must outlive the guard.
  ExitGuard(const bool& busy, Fail fail);
  ~ExitGuard();
  ExitGuard(const ExitGuard&) = delete;
  ExitGuard& operator=(const ExitGuard&) = delete;

  /// For the handlers of the end of the process.
  bool busy() const;
  void fail(const std::string& what) const { fail_(what); }

 private:
  const bool* busy_;
  pid_t process_;
  Fail fail_;
};

/// To be called on the thread that is about to end this process. If a run is busy, it fails, and this does not return.
/// `what` is what the FMU did, in the past tense: "called exit()".
void end_busy_runs(const char* what);

/// For the handler of a signal that would end this process, sent by a timer or by the process itself. In a call to an
/// FMU: as end_busy_runs(). Outside of calls the master's own work is not torn apart: the signal is kept for
/// take_kept_signal(). Returns false if no run is busy.
bool end_by_signal(int signal);

/// Returns what happened if end_by_signal() kept a signal since the last call. For the thread that steps, between two
/// calls to FMUs.
std::optional<std::string> take_kept_signal();

/// From now on a signal that ends the process inside an FMU is reported on standard error, with instance, call and
/// time, before it takes its course: SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS. A signal of a timer, or
/// one that the process sends itself, fails the runs that are busy (see end_by_signal()). A signal that somebody
/// handles already stays theirs, and so does SIGALRM while the program around has a timer. From any thread; once is
/// enough.
void install_crash_notice();

/// Returns true if the signal would end the process: its only handler is that of install_crash_notice().
bool ends_process(int signal);

/// "SIGALRM"; "signal 40" if it has no name.
std::string signal_name(int signal);

}  // namespace mebots::master
