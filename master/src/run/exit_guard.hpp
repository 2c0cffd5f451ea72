// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace mebots::master {

/// exit() inside an FMU ends the process in the middle of a run, with the code that the FMU likes. While one of these
/// lives and its run is busy, such an end is a failure of the run: the reason, with instance and call, is handed to
/// `fail`, which writes results and summary, and the process ends with code 1. _exit() asks nobody: against it there
/// is only a process of its own for the instance.
class ExitGuard {
 public:
  using Fail = std::function<void(const std::string& what)>;

  /// `busy` says whether the run is in a step; it must outlive the guard.
  ExitGuard(const bool& busy, Fail fail);
  ~ExitGuard();
  ExitGuard(const ExitGuard&) = delete;
  ExitGuard& operator=(const ExitGuard&) = delete;

  /// For the handler of the process's end.
  bool busy() const { return *busy_; }
  void fail(const std::string& what) const { fail_(what); }

 private:
  const bool* busy_;
  Fail fail_;
};

}  // namespace mebots::master
