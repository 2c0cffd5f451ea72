// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/time.h>

#include <array>
#include <map>
#include <string>
#include <vector>

namespace mebots::master {

/// The timers of this process: the three of setitimer(), of which alarm() uses the first, and those of timer_create().
/// The kernel lists the latter in /proc/self/timers; if it does not, they are not compared.
class TimerState {
 public:
  /// Reads the timers that run.
  TimerState();

  /// Appends one text for each timer that runs now and did not at construction, or the other way round. If the
  /// timer's signal would end the process, the timer is stopped. If the signal has a handler, the timer may be how the
  /// FMU works: it stays, and is reported once in the life of the process.
  void put_right(std::vector<std::string>& texts) const;

 private:
  static constexpr std::array kInterval = {ITIMER_REAL, ITIMER_VIRTUAL, ITIMER_PROF};
  /// By the kernel's number: the signal of each timer.
  using Created = std::map<int, int>;

  static Created created();
  void compare_intervals(std::vector<std::string>& texts) const;
  void compare_created(std::vector<std::string>& texts) const;

  std::array<itimerval, kInterval.size()> intervals_{};
  Created created_;
};

/// Stops the timer of setitimer() that sends this signal, if there is one.
void stop_timers_of(int signal);

}  // namespace mebots::master
