// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.hpp"

#include <atomic>
#include <exception>
#include <functional>
#include <string_view>

namespace mebots::check {

/// Receives the findings of an experiment that runs in a child process, and sends them to the parent.
class Witness {
 public:
  virtual ~Witness() = default;
  virtual void error(std::string text, std::string way_out) = 0;
  virtual void warning(std::string text, std::string way_out) = 0;
  /// Reports a warning of the level pedantic.
  virtual void remark(std::string text, std::string way_out) = 0;
  /// Records the next call to the FMU, so that a crash report can name this call.
  virtual void doing(std::string_view what) = 0;
};

/// Thrown if the user cancels the check.
class Interrupted final : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

/// The severity and the remedy that are reported if the child crashes, exits or hangs.
struct CrashRule {
  Severity severity = Severity::error;
  std::string way_out = "run the FMU under a debugger, or build it with -fsanitize=address";
  double deadline_s = 30;                       ///< counts processor and sleeping time, but no waiting for a processor
  const std::atomic<bool>* given_up = nullptr;  ///< if it becomes true, the child is ended; null: never
};

/// An experiment that runs in a separate child process.
struct ChildProbe {
  std::string name;     ///< a statement that is true if the probe finds no error
  std::string skipped;  ///< why the probe does not apply to this FMU; empty if it applies
  std::function<void(Witness&)> run;
  bool is_plain = false;  ///< true for a plain run: if it fails, all following probes are skipped
};

/// Runs foreign code in a forked child that has a deadline and no standard output. If the child crashes, exits or
/// hangs, its earlier findings are kept, and the event is added as a finding. When this function returns, the child and
/// all its descendants have ended. They also end if this process ends. If a callback of mebots crashes, a second run
/// uses callbacks that do nothing. If the second run crashes too, the FMU is reported as the cause, otherwise the
/// callback. The calling process must have only one thread. Throws mebots::Error if no child can be created, or if a
/// callback of mebots failed. Throws Interrupted after the child has ended if the user cancelled the check.
void run_in_child(const CrashRule& rule, Findings findings, const std::function<void(Witness&)>& work);

}  // namespace mebots::check
