// SPDX-License-Identifier: Apache-2.0
#include "slave/fmi/pending_step.hpp"

#include "slave/fmi/instance_calls.hpp"

#include <algorithm>
#include <utility>

namespace mebots::master {

void PendingStep::begin() {
  const std::lock_guard lock(mutex_);
  status_.reset();
}

void PendingStep::finished(int status) {
  {
    const std::lock_guard lock(mutex_);
    status_ = status;
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
    const auto queried = status_of_fmu();
    if (queried.value_or(InstanceCalls::kPending) != InstanceCalls::kPending) return *queried;
    if (!queried && called_back) return *called_back;
  }
  return InstanceCalls::kPending;
}

}  // namespace mebots::master
