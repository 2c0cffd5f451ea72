// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <functional>
#include <string>

namespace mebots::master {

/// exit() inside an FMU ends the process in the middle of a run, with the code that the FMU likes. While one of these
/// lives and its run is busy, such an end is a failure of the run. The reason, with instance and call, is handed to
/// `fail`, which writes results and summary, and the process ends with code 1. The C library asks for exit() and
/// quick_exit(), but not for _exit(): a program has one of its own for that (app/own_exit.cpp). Processes that an FMU
/// forks end as they like. Against an end by the kernel there is only a process of its own for the instance.
class ExitGuard {
 public:
  using Fail = std::function<void(const std::string& what)>;

  /// `busy` says whether the run is in a step; it must outlive the guard.
  ExitGuard(const bool& busy, Fail fail);
  ~ExitGuard();
  ExitGuard(const ExitGuard&) = delete;
  ExitGuard& operator=(const ExitGuard&) = delete;

  /// For who handles the end of the process.
  bool busy() const;
  void fail(const std::string& what) const { fail_(what); }

 private:
  const bool* busy_;
  pid_t process_;
  Fail fail_;
};

/// For who is about to end this process by `function`, on the thread that called it: where a run is busy it fails, and
/// this does not return.
void end_busy_runs(const char* function);

}  // namespace mebots::master
