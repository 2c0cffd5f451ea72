// SPDX-License-Identifier: Apache-2.0
#include "fmi/process/process_state.hpp"

#include "fmi/call/exit_guard.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

namespace mebots::master {
namespace {

/// Reports a change and whether it was reverted. A change that was not reverted is reported only once.
void report(std::vector<std::string>& texts, const std::string& text, bool undone) {
  if (undone || is_new_change(text)) texts.push_back(text + (undone ? " (put back)" : " (cannot be put back)"));
}

/// Lists the signals that are in `now` but not in `before`, such as "SIGINT, SIGTERM and 3 more".
std::string added_signals(const sigset_t& now, const sigset_t& before) {
  constexpr std::size_t kShown = 4;
  std::vector<std::string> names;
  for (int signal = 1; signal <= SIGRTMAX; ++signal) {
    if (sigismember(&now, signal) == 1 && sigismember(&before, signal) == 0) names.push_back(signal_name(signal));
  }
  const auto more = names.size() - std::min(names.size(), kShown);
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "), more == 0 ? "" : fmt::format(" and {} more", more));
}

const char* policy_name(int policy) {
  switch (policy & ~SCHED_RESET_ON_FORK) {
    case SCHED_OTHER:
      return "SCHED_OTHER";
    case SCHED_FIFO:
      return "SCHED_FIFO";
    case SCHED_RR:
      return "SCHED_RR";
    case SCHED_BATCH:
      return "SCHED_BATCH";
    case SCHED_IDLE:
      return "SCHED_IDLE";
    default:
      return "another one";
  }
}

int current_nice() {
  return getpriority(PRIO_PROCESS, 0);  // 0 is the calling thread
}

/// Returns the processors of the calling thread; an empty set if the machine has more processors than a cpu_set_t.
cpu_set_t current_processors() {
  cpu_set_t processors{};
  if (sched_getaffinity(0, sizeof processors, &processors) != 0) CPU_ZERO(&processors);
  return processors;
}

int current_death_signal() {
  int signal = 0;
  prctl(PR_GET_PDEATHSIG, &signal);
  return signal;
}

}  // namespace

ThreadState::ThreadState()
    : thread_(gettid()),
      nice_(current_nice()),
      policy_(sched_getscheduler(0)),
      processors_(current_processors()),
      death_signal_(current_death_signal()) {
  pthread_sigmask(SIG_SETMASK, nullptr, &mask_);
  sigaltstack(nullptr, &stack_);
  sched_getparam(0, &parameters_);
}

bool ThreadState::is_mask_changed() const {
  sigset_t now{};
  pthread_sigmask(SIG_SETMASK, nullptr, &now);
  return std::memcmp(&now, &mask_, sizeof now) != 0 && thread_ == gettid();
}

void ThreadState::compare_mask(std::vector<std::string>& texts) const {
  sigset_t now;
  pthread_sigmask(SIG_SETMASK, nullptr, &now);
  const auto blocked = added_signals(now, mask_);
  const auto unblocked = added_signals(mask_, now);
  if (blocked.empty() && unblocked.empty()) return;
  const bool back = pthread_sigmask(SIG_SETMASK, &mask_, nullptr) == 0;
  if (!blocked.empty()) report(texts, "the signal mask blocks " + blocked, back);
  if (!unblocked.empty()) report(texts, "the signal mask no longer blocks " + unblocked, back);
}

void ThreadState::compare_stack(std::vector<std::string>& texts) const {
  stack_t now{};
  sigaltstack(nullptr, &now);
  const bool same_place = now.ss_sp == stack_.ss_sp && now.ss_size == stack_.ss_size;
  const bool both_off = (now.ss_flags & stack_.ss_flags & SS_DISABLE) != 0;
  if (both_off || (same_place && now.ss_flags == stack_.ss_flags)) return;
  report(texts, "the alternate signal stack changed", sigaltstack(&stack_, nullptr) == 0);
}

void ThreadState::compare_scheduling(std::vector<std::string>& texts) const {
  sched_param parameters{};
  sched_getparam(0, &parameters);
  const int policy = sched_getscheduler(0);
  if (policy != policy_ || parameters.sched_priority != parameters_.sched_priority) {
    report(
        texts,
        fmt::format("the scheduling policy became {} with priority {}", policy_name(policy), parameters.sched_priority),
        sched_setscheduler(0, policy_, &parameters_) == 0);
  }
  if (const int nice = current_nice(); nice != nice_) {
    report(texts, fmt::format("the priority (nice value) became {}", nice), setpriority(PRIO_PROCESS, 0, nice_) == 0);
  }
  const auto processors = current_processors();
  if (CPU_EQUAL(&processors, &processors_) == 0) {
    report(texts,
           fmt::format("the affinity became {} of {} processors", CPU_COUNT(&processors), CPU_COUNT(&processors_)),
           sched_setaffinity(0, sizeof processors_, &processors_) == 0);
  }
}

void ThreadState::compare_death_signal(std::vector<std::string>& texts) const {
  const int now = current_death_signal();
  if (now == death_signal_) return;
  report(texts, fmt::format("the parent-death signal became {}", now == 0 ? "none" : signal_name(now)),
         prctl(PR_SET_PDEATHSIG, death_signal_) == 0);
}

void ThreadState::put_right(std::vector<std::string>& texts) const {
  if (thread_ != gettid()) return;
  compare_mask(texts);
  compare_stack(texts);
  compare_scheduling(texts);
  compare_death_signal(texts);
}

}  // namespace mebots::master
