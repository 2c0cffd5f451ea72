// SPDX-License-Identifier: Apache-2.0
#include "fmi/call/exit_guard.hpp"

#include "base/time.hpp"
#include "fmi/call/callbacks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <mutex>
#include <vector>

namespace mebots::master {
namespace {

struct Guards {
  std::mutex mutex;
  std::vector<const ExitGuard*> all;
};

Guards& guards() {
  static Guards& all = *new Guards;  // never destroyed, because handlers use it until the process ends
  return all;
}

constexpr const char* kRemedy =
    "which ends the whole process. Run the instance in a separate process (\"process\": \"own\", or --isolate)";

std::string reason(const char* what) {
  const auto call = current_call();
  if (call.library != nullptr)
    return fmt::format("the library of the FMU {} {} while it was {}, {}", call.library, what, call.function, kRemedy);
  if (call.instance == nullptr) {
    return fmt::format("a library of an FMU (instances: {}) {} in the middle of a run, {}",
                       fmt::join(instances_here(), ", "), what, kRemedy);
  }
  return fmt::format("instance '{}' at {} s: its FMU {} in {}, {}", call.instance, to_seconds(call.time_ns), what,
                     call.function, kRemedy);
}

/// Id of the process that created the latest ExitGuard. Guards have no effect in other processes, such as forked
/// copies.
std::atomic<pid_t> guarded_process = 0;
/// Id of the thread in which end_busy_runs() is ending the process; 0 if there is no such thread.
std::atomic<pid_t> ending_thread = 0;
/// A signal that was received outside of calls to FMUs; 0 if there was none.
std::atomic<int> kept_signal = 0;

[[noreturn]] void end_at_once() {
  for (;;) syscall(SYS_exit_group, EXIT_FAILURE);
}

/// Waits forever if another thread is ending the process. If the calling thread is ending it, ends it immediately.
/// Returns if no thread is ending it.
void leave_it_to_the_ending_thread() {
  const pid_t ending = ending_thread.load();
  if (ending == 0) return;
  if (ending == gettid()) end_at_once();
  for (;;) pause();
}

/// Limits the time for writing results at the end of the process. The interrupted code may hold locks of the heap, for
/// which writing would wait forever. The alarm then ends the process without results.
void end_by_alarm() {
  constexpr unsigned kLongestEndS = 60;
  std::signal(SIGALRM, SIG_DFL);
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGALRM);
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
  alarm(kLongestEndS);
}

/// Locks the mutex of the guards. Gives up after one second, because the interrupted code of this thread may hold the
/// mutex.
std::unique_lock<std::mutex> lock_known_guards() {
  constexpr int kTries = 1000;
  constexpr timespec kPause{0, 1'000'000};
  std::unique_lock lock(guards().mutex, std::defer_lock);
  for (int i = 0; i < kTries && !lock.try_lock(); ++i) nanosleep(&kPause, nullptr);
  return lock;
}

/// Registers handlers for exit() and quick_exit(). They run while the FMU's functions are still on the stack.
bool register_exit_handler() {
  return std::atexit([] { end_busy_runs("called exit()"); }) == 0 &&
         std::at_quick_exit([] { end_busy_runs("called quick_exit()"); }) == 0;
}

}  // namespace

void end_busy_runs(const char* what) {
  if (guarded_process.load() != getpid()) return;
  std::vector<const ExitGuard*> busy;
  {
    const auto lock = lock_known_guards();
    if (!lock.owns_lock()) end_at_once();
    auto& all = guards().all;
    std::ranges::copy_if(all, std::back_inserter(busy), &ExitGuard::busy);
    for (const auto* guard : busy) std::erase(all, guard);  // reports the end only once
    if (!busy.empty()) ending_thread = gettid();
  }
  if (busy.empty()) {
    leave_it_to_the_ending_thread();
    return;
  }
  end_by_alarm();
  const auto text = reason(what);
  for (const auto* guard : busy) guard->fail(text);
  std::fprintf(stderr, "mebots: error: %s\n", text.c_str());
  std::fflush(nullptr);
  end_at_once();
}

bool end_by_signal(int signal) {
  if (guarded_process.load() != getpid()) return false;
  const auto call = current_call();
  if (call.instance != nullptr || call.library != nullptr) {
    end_busy_runs(fmt::format("caused the signal {}", signal_name(signal)).c_str());
    return false;
  }
  const std::unique_lock lock(guards().mutex, std::try_to_lock);
  // If another thread holds the mutex, it is creating or destroying a guard. Then it is unknown whether a guard is
  // busy, and the signal is stored as if one were.
  if (lock.owns_lock() && std::ranges::none_of(guards().all, &ExitGuard::busy)) return false;
  kept_signal = signal;
  return true;
}

std::optional<std::string> take_kept_signal() {
  if (kept_signal.load(std::memory_order_relaxed) == 0) return std::nullopt;
  return fmt::format(
      "the process received the signal {} from a timer or from itself, and has no handler for it: one of its FMUs "
      "(instances: {}) caused it, {}",
      signal_name(kept_signal.exchange(0)), fmt::join(instances_here(), ", "), kRemedy);
}

ExitGuard::ExitGuard(const bool& busy, Fail fail) : busy_(&busy), process_(getpid()), fail_(std::move(fail)) {
  static const bool is_registered = register_exit_handler();
  static_cast<void>(is_registered);
  guarded_process = process_;
  auto& known = guards();
  const std::lock_guard lock(known.mutex);
  known.all.push_back(this);
}

ExitGuard::~ExitGuard() {
  auto& known = guards();
  const std::lock_guard lock(known.mutex);
  std::erase(known.all, this);
}

bool ExitGuard::busy() const {
  return *busy_ && process_ == getpid();
}

}  // namespace mebots::master
