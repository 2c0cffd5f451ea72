// SPDX-License-Identifier: Apache-2.0
#include "slave/fmi/pending_step.hpp"

#include "slave/fmi/instance_calls.hpp"

#include <algorithm>
#include <chrono>

namespace mebots::master {

void PendingStep::begin() {
  const std::lock_guard lock(mutex_);
  status_.reset();
}

StepResult PendingStep::continues() {
  is_under_way_ = true;
  StepResult result;
  result.done = false;
  result.pending = true;
  return result;
}

StepResult PendingStep::cancelled() {
  StepResult result;
  result.done = false;
  result.cancelled = true;
  return result;
}

void PendingStep::finished(int status) {
  {
    const std::lock_guard lock(mutex_);
    status_ = status;
  }
  over_.notify_all();
}

int PendingStep::wait(const std::atomic<bool>& cancel, const std::function<int()>& ask) {
  const int status = wait_for_status(cancel, ask);
  is_under_way_ = false;
  return status;
}

int PendingStep::wait_for_status(const std::atomic<bool>& cancel, const std::function<int()>& ask) {
  constexpr std::chrono::microseconds kLongestPause{2000};
  std::chrono::microseconds pause{20};
  while (!cancel.load(std::memory_order_relaxed)) {
    {
      std::unique_lock lock(mutex_);
      if (over_.wait_for(lock, pause, [this] { return status_.has_value(); })) return *status_;
    }
    pause = std::min(2 * pause, kLongestPause);
    const int status = ask();
    if (status != InstanceCalls::kPending) return status;
  }
  return InstanceCalls::kPending;
}

}  // namespace mebots::master
