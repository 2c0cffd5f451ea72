// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.hpp"

#include <atomic>
#include <exception>
#include <functional>
#include <string_view>

namespace mebots::check {

/// What code in a child process may tell its parent.
class Witness {
 public:
  virtual ~Witness() = default;
  virtual void error(std::string text, std::string way_out) = 0;
  virtual void warning(std::string text, std::string way_out) = 0;
  /// A warning at level pedantic.
  virtual void remark(std::string text, std::string way_out) = 0;
  /// What is about to be called: the last words before a crash.
  virtual void doing(std::string_view what) = 0;
};

/// The user gave up.
class Interrupted final : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

/// How a crash, an exit or a hang in the child counts, and what to advise.
struct CrashRule {
  Severity severity = Severity::error;
  std::string way_out = "run it under a debugger or with -fsanitize=address";
  double deadline_s = 30;                       ///< of computing and sleeping; not of waiting for a processor
  const std::atomic<bool>* given_up = nullptr;  ///< true ends the child; null = nobody can
};

/// Runs foreign code where it can do no harm: in a forked child, with a deadline, without standard output. Whatever
/// becomes of it, the child's findings so far arrive, and a crash, an exit or a hang becomes a finding itself. The
/// child and all processes that came of it are gone afterwards; they end with this process, too. A crash in a callback
/// of ours is looked into by a second run, in which the callbacks do nothing: the FMU's if it crashes again, else ours.
/// The calling process must have one thread only. Throws mebots::Error when no child can be made, and when a callback
/// of ours is what failed; Interrupted when the user gave up, once the child is gone.
void run_in_child(const CrashRule& rule, Findings findings, const std::function<void(Witness&)>& work);

}  // namespace mebots::check
