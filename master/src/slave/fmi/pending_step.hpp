// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>

namespace mebots::master {

/// A step of FMI 1.0 or 2.0 that continues in the FMU after DoStep has returned fmiPending. The FMU reports its end by
/// the callback stepFinished, by GetStatus, or by both.
class PendingStep {
 public:
  using Clock = std::chrono::steady_clock;

  /// Resets the state. Call it before DoStep, because the callback may precede its return.
  void begin();
  /// The callback stepFinished. From any thread.
  void finished(int status);
  /// Waits for the end of the step and returns its status; fmiPending if `cancel` becomes true, or `until` is reached.
  /// Queries the FMU by `status_of_fmu`, every 20 us at first and every 2 ms later. The query decides: a callback that
  /// arrives late belongs to an earlier step. The callback decides only if the query returns nothing.
  int wait(const std::atomic<bool>& cancel, const std::function<std::optional<int>()>& status_of_fmu,
           Clock::time_point until = Clock::time_point::max());

 private:
  std::mutex mutex_;
  std::condition_variable over_;
  std::optional<int> status_;
};

}  // namespace mebots::master
