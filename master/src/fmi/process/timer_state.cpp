// SPDX-License-Identifier: Apache-2.0
#include "fmi/process/process_state.hpp"

#include "fmi/call/exit_guard.hpp"

#include <fmt/format.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

namespace mebots::master {
namespace {

constexpr std::array kNames = {"ITIMER_REAL, as by alarm(),", "ITIMER_VIRTUAL", "ITIMER_PROF"};
constexpr std::array kTimerSignals = {SIGALRM, SIGVTALRM, SIGPROF};

bool runs(const itimerval& timer) {
  return timer.it_value.tv_sec != 0 || timer.it_value.tv_usec != 0;
}

bool repeats(const itimerval& timer) {
  return timer.it_interval.tv_sec != 0 || timer.it_interval.tv_usec != 0;
}

/// Reports a timer and whether it was stopped. A timer that continues is reported only once.
void report(std::vector<std::string>& texts, const std::string& what, int signal, bool stopped) {
  if (stopped) texts.push_back(what + " (stopped)");
  if (!stopped && is_new_change(what))
    texts.push_back(fmt::format("{} (left running: {} does not end the process)", what, signal_name(signal)));
}

}  // namespace

void stop_timers_of(int signal) {
  constexpr std::array kTimers = {ITIMER_REAL, ITIMER_VIRTUAL, ITIMER_PROF};
  const itimerval none{};
  for (std::size_t i = 0; i < kTimers.size(); ++i) {
    if (kTimerSignals[i] == signal) setitimer(kTimers[i], &none, nullptr);
  }
}

TimerState::TimerState() : created_(created()) {
  for (std::size_t i = 0; i < kInterval.size(); ++i) getitimer(kInterval[i], &intervals_[i]);
}

TimerState::Created TimerState::created() {
  Created timers;
  std::ifstream list("/proc/self/timers");
  int number = -1;
  for (std::string key; list >> key;) {
    int signal = 0;
    if (key == "ID:") list >> number;
    std::string notification;
    // The line contains the signal and an address, such as "signal: 60/00007fff86e452a8". Reads only the signal.
    if (key == "signal:" && list >> signal) timers[number] = signal;
    if (key == "notify:" && list >> notification && notification.starts_with("none")) timers.erase(number);
  }
  return timers;
}

void TimerState::compare_intervals(std::vector<std::string>& texts) const {
  for (std::size_t i = 0; i < kInterval.size(); ++i) {
    itimerval now{};
    getitimer(kInterval[i], &now);
    const auto& before = intervals_[i];
    if (runs(now) && !runs(before)) {
      const itimerval none{};
      const bool stopped = ends_process(kTimerSignals[i]) && setitimer(kInterval[i], &none, nullptr) == 0;
      report(texts, fmt::format("the timer {} runs", kNames[i]), kTimerSignals[i], stopped);
    }
    if (!runs(now) && repeats(before) && setitimer(kInterval[i], &before, nullptr) == 0) {
      texts.push_back(fmt::format("the timer {} was stopped (started again)", kNames[i]));
    }
  }
}

void TimerState::compare_created(std::vector<std::string>& texts) const {
  for (const auto& [number, signal] : created()) {
    if (created_.contains(number)) continue;
    const bool deleted = ends_process(signal) && syscall(SYS_timer_delete, number) == 0;
    report(texts, fmt::format("a timer that sends {} was made by timer_create()", signal_name(signal)), signal,
           deleted);
  }
}

void TimerState::put_right(std::vector<std::string>& texts) const {
  compare_intervals(texts);
  compare_created(texts);
}

}  // namespace mebots::master
