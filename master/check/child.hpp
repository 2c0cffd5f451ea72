// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.hpp"

#include <atomic>
#include <exception>
#include <functional>
#include <string_view>

namespace mebots::check {

/// Sends the findings of an experiment from its child process to the parent.
class Witness {
 public:
  virtual ~Witness() = default;
  virtual void error(std::string text, std::string way_out) = 0;
  virtual void warning(std::string text, std::string way_out) = 0;
  /// Reports a warning at level pedantic.
  virtual void remark(std::string text, std::string way_out) = 0;
  /// Records the name of the next call, which a crash report contains.
  virtual void doing(std::string_view what) = 0;
};

/// Thrown if the user cancels the check.
class Interrupted final : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

/// Determines the finding if the child crashes, exits or hangs.
struct CrashRule {
  Severity severity = Severity::error;
  std::string way_out = "run the FMU under a debugger, or build it with -fsanitize=address";
  double deadline_s = 30;                       ///< processor and sleeping time [s], without waiting for a processor
  const std::atomic<bool>* given_up = nullptr;  ///< if this flag becomes true, kills the child; may be null
};

struct ChildProbe {
  std::string name;     ///< the property that holds if the probe finds no error
  std::string skipped;  ///< reason why the probe does not apply; empty if it applies
  std::function<void(Witness&)> run;
  bool is_plain = false;  ///< true for a plain run; if it fails, all later probes are skipped
};

/// Runs foreign code in a forked child with a deadline and no standard output. A crash, an exit or a timeout becomes a
/// finding; earlier findings are kept. After the return, the child and its descendants have ended. They also end if
/// this process ends.
///
/// If a callback of MEbots crashes, repeats the experiment with empty callbacks. If the FMU then crashes outside
/// callbacks, the FMU is the cause; otherwise, throws Error.
///
/// The calling process must have only one thread. Throws Error if no child can be created, and Interrupted if the user
/// cancelled the check.
void run_in_child(const CrashRule& rule, Findings findings, const std::function<void(Witness&)>& work);

}  // namespace mebots::check
