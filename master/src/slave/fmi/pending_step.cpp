// SPDX-License-Identifier: Apache-2.0
#include "slave/fmi/pending_step.hpp"

#include "slave/fmi/instance_calls.hpp"

#include <algorithm>
#include <utility>

namespace mebots::master {

void PendingStep::begin() {
  const std::lock_guard lock(mutex_);
  status_.reset();
  callbacks_ = std::min(callbacks_, steps_);  // other callbacks belong to steps that DoStep has completed itself
}

void PendingStep::continues() {
  const std::lock_guard lock(mutex_);
  ++steps_;
}

void PendingStep::finished(int status) {
  {
    const std::lock_guard lock(mutex_);
    status_ = status;
    ++callbacks_;
    last_callback_ = Clock::now();
  }
  over_.notify_all();
}

int PendingStep::wait(const std::atomic<bool>& cancel, const std::function<std::optional<int>()>& status_of_fmu,
                      Clock::time_point until) {
  constexpr std::chrono::microseconds kLongestPause{2000};
  std::chrono::microseconds pause{20};
  std::optional<int> called_back;
  while (!cancel.load(std::memory_order_relaxed) && Clock::now() < until) {
    {
      std::unique_lock lock(mutex_);
      over_.wait_for(lock, pause, [this] { return status_.has_value(); });
      if (const auto status = std::exchange(status_, std::nullopt)) called_back = status;
    }
    pause = std::min(2 * pause, kLongestPause);
    const auto queried = is_status_ignored_ ? std::nullopt : status_of_fmu();
    if (queried.value_or(InstanceCalls::kPending) != InstanceCalls::kPending) return *queried;
    if (!called_back) continue;
    if (queried) is_status_ignored_ = is_denied();
    if (!queried || is_status_ignored_) return *called_back;
  }
  return InstanceCalls::kPending;
}

bool PendingStep::is_denied() {
  const std::lock_guard lock(mutex_);
  return callbacks_ >= steps_ && Clock::now() - last_callback_ > kLongestDenial;
}

}  // namespace mebots::master
