// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.hpp"

#include <atomic>
#include <exception>
#include <functional>
#include <string_view>

namespace mebots::check {

/// Receives the reports of an experiment in a child process, and sends them to the parent.
class Witness {
 public:
  virtual ~Witness() = default;
  virtual void error(std::string text, std::string way_out) = 0;
  virtual void warning(std::string text, std::string way_out) = 0;
  /// Reports a warning at level pedantic.
  virtual void remark(std::string text, std::string way_out) = 0;
  /// Records the next call to the FMU, so that a crash report can name this call.
  virtual void doing(std::string_view what) = 0;
};

/// Thrown if the user cancels the check.
class Interrupted final : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

/// States the severity of a crash, an exit or a hang of the child, and the remedy to suggest.
struct CrashRule {
  Severity severity = Severity::error;
  std::string way_out = "run the FMU under a debugger, or build it with -fsanitize=address";
  double deadline_s = 30;                       ///< of computing and sleeping, not of waiting for a processor
  const std::atomic<bool>* given_up = nullptr;  ///< true ends the child; null = never
};

/// An experiment that runs in a separate child process.
struct ChildProbe {
  std::string name;     ///< a statement that holds if the probe finds no error
  std::string skipped;  ///< why it does not apply to this FMU; empty if it applies
  std::function<void(Witness&)> run;
  bool is_plain = false;  ///< a plain run: if it fails, the following probes are skipped
};

/// Runs foreign code safely: in a forked child with a deadline and without standard output. Findings before a crash, an
/// exit or a hang of the child are kept, and this event becomes a finding too. When the function returns, the child and
/// all its descendants have ended. They also end if this process ends. If a callback of mebots crashes, a second run
/// uses callbacks that do nothing. If the second run crashes, too, the cause is the FMU; otherwise it is the callback.
/// The calling process must have one thread only. Throws mebots::Error if no child can be created or a callback of
/// mebots failed. If the user cancelled, throws Interrupted after the child has ended.
void run_in_child(const CrashRule& rule, Findings findings, const std::function<void(Witness&)>& work);

}  // namespace mebots::check
