// SPDX-License-Identifier: Apache-2.0
#include "base/signal_guard.hpp"

#include <array>
#include <csignal>
#include <mutex>

namespace mebots::master {
namespace {

// A signal handler can reach nothing but globals; lock-free atomics are all it may touch.
std::array<std::atomic<std::atomic<bool>*>, SignalGuard::kMost> flags{};
std::atomic<int> last_signal{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<std::atomic<bool>*>::is_always_lock_free);

constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP};

std::mutex guards_mutex;
int guards = 0;
std::array<struct sigaction, kSignals.size()> before{};

void on_signal(int signal) {
  last_signal.store(signal, std::memory_order_relaxed);
  for (auto& slot : flags) {
    if (auto* flag = slot.load(std::memory_order_relaxed)) flag->store(true, std::memory_order_relaxed);
  }
}

void install() {
  last_signal = 0;
  struct sigaction action {};
  action.sa_handler = on_signal;
  // The second signal finds the default again: it helps where an FMU's call does not come back.
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &action, &before[i]);
}

void restore() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &before[i], nullptr);
}

}  // namespace

SignalGuard::SignalGuard(std::atomic<bool>& flag) {
  const std::lock_guard lock(guards_mutex);
  for (int i = 0; i < kMost && slot_ < 0; ++i) {
    std::atomic<bool>* none = nullptr;
    if (flags[static_cast<std::size_t>(i)].compare_exchange_strong(none, &flag)) slot_ = i;
  }
  if (guards++ == 0) install();
}

SignalGuard::~SignalGuard() {
  const std::lock_guard lock(guards_mutex);
  if (slot_ >= 0) flags[static_cast<std::size_t>(slot_)] = nullptr;
  if (--guards == 0) restore();
}

int SignalGuard::signal() noexcept {
  return last_signal.load(std::memory_order_relaxed);
}

}  // namespace mebots::master
