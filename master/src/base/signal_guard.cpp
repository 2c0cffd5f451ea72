// SPDX-License-Identifier: Apache-2.0
#include "base/signal_guard.hpp"

#include <array>
#include <csignal>
#include <mutex>

namespace mebots::master {
namespace {

// A signal handler may access only lock-free atomic global variables.
struct Slot {
  std::atomic<std::atomic<bool>*> flag{nullptr};
  std::atomic<int> signal{0};
};
std::array<Slot, SignalGuard::kMost> slots;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<std::atomic<bool>*>::is_always_lock_free &&
              std::atomic<int>::is_always_lock_free);

constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP};

// Protected by guards_mutex.
std::mutex guards_mutex;
int guards = 0;
int to_raise = 0;
std::array<struct sigaction, kSignals.size()> handlers_before{};

void on_signal(int signal) {
  for (auto& slot : slots) {
    if (auto* flag = slot.flag.load()) {
      slot.signal.store(signal);
      flag->store(true);
    }
  }
}

void install() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  // After the first signal, restores the default action, so that the second signal ends the process even if a call to
  // an FMU does not return.
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    sigaction(kSignals[i], nullptr, &handlers_before[i]);
    // An ignored signal (nohup) stays ignored.
    if (handlers_before[i].sa_handler != SIG_IGN) sigaction(kSignals[i], &action, nullptr);
  }
}

void restore() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &handlers_before[i], nullptr);
}

}  // namespace

SignalGuard::SignalGuard(std::atomic<bool>& flag, Afterwards afterwards) : afterwards_(afterwards) {
  const std::lock_guard lock(guards_mutex);
  for (int i = 0; i < kMost && slot_ < 0; ++i) {
    auto& slot = slots[static_cast<std::size_t>(i)];
    if (slot.flag.load() != nullptr) continue;
    slot.signal = 0;
    slot.flag = &flag;
    slot_ = i;
  }
  if (guards++ == 0) install();
}

SignalGuard::~SignalGuard() {
  int signal_to_raise = 0;
  {
    const std::lock_guard lock(guards_mutex);
    if (afterwards_ == Afterwards::raise && signal() != 0) to_raise = signal();
    if (slot_ >= 0) slots[static_cast<std::size_t>(slot_)].flag = nullptr;
    if (--guards == 0) {
      restore();
      signal_to_raise = to_raise;
      to_raise = 0;
    }
  }
  if (signal_to_raise != 0) std::raise(signal_to_raise);
}

int SignalGuard::signal() const noexcept {
  return slot_ < 0 ? 0 : slots[static_cast<std::size_t>(slot_)].signal.load();
}

}  // namespace mebots::master
