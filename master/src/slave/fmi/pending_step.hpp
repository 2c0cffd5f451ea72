// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>

namespace mebots::master {

/// A step of FMI 1.0 or 2.0 that continues in the FMU after DoStep has returned fmiPending. The FMU reports its end by
/// the callback stepFinished, by GetStatus, or by both.
class PendingStep {
 public:
  using Clock = std::chrono::steady_clock;

  /// Resets the state. Must be called before DoStep, because the callback stepFinished may occur before DoStep returns.
  void begin();
  /// Called when DoStep has returned fmiPending.
  void continues();
  /// Handles the callback stepFinished. May be called from any thread.
  void finished(int status);
  /// Waits for the end of the step and returns the step's status. Returns fmiPending if `cancel` becomes true, or
  /// `until` is reached. Queries the FMU by `status_of_fmu`, first after 20 us and later every 2 ms. The result of the
  /// query determines whether the step has ended, because a late callback may belong to an earlier step. A callback
  /// ends the step only in two cases. In the first case, the query returns nothing. In the second case, as many
  /// callbacks as pending steps have occurred, and the query still reports fmiPending after kLongestDenial.
  int wait(const std::atomic<bool>& cancel, const std::function<std::optional<int>()>& status_of_fmu,
           Clock::time_point until = Clock::time_point::max());
  /// True if GetStatus has reported fmiPending although callbacks had reported the end of the step. GetStatus is then
  /// not called again.
  bool is_status_ignored() const { return is_status_ignored_; }

 private:
  static constexpr std::chrono::seconds kLongestDenial{2};

  bool is_denied();

  std::mutex mutex_;
  std::condition_variable over_;
  std::optional<int> status_;
  std::uint64_t steps_ = 0;      // pending ones so far
  std::uint64_t callbacks_ = 0;  // for these steps, late ones included
  Clock::time_point last_callback_;
  bool is_status_ignored_ = false;  // used by the stepping thread alone
};

}  // namespace mebots::master
