// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sched.h>

#include <csignal>
#include <string>
#include <vector>

namespace mebots::master {

/// What an FMU can change of the thread that calls it: signal mask, alternate signal stack, nice value, scheduling
/// policy, processor affinity, parent-death signal. On Linux, all of them belong to the thread.
class ThreadState {
 public:
  /// Reads the state of the calling thread.
  ThreadState();

  /// Appends one text for each difference from the state at construction, and undoes what it can. A change that stays
  /// is reported once in the life of the process. No effect on another thread than the one of the constructor.
  void put_right(std::vector<std::string>& texts) const;
  /// Returns true if the signal mask is another: a cheap question.
  bool is_mask_changed() const;

 private:
  void compare_mask(std::vector<std::string>& texts) const;
  void compare_stack(std::vector<std::string>& texts) const;
  void compare_scheduling(std::vector<std::string>& texts) const;
  void compare_death_signal(std::vector<std::string>& texts) const;

  pid_t thread_;
  sigset_t mask_{};
  stack_t stack_{};
  int nice_;
  int policy_;
  sched_param parameters_{};
  cpu_set_t processors_{};
  int death_signal_ = 0;
};

}  // namespace mebots::master
