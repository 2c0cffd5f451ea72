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

/// A step of FMI 1.0 or 2.0 that continues in the FMU after DoStep has returned fmiPending. The FMU reports the end of
/// the step by the callback stepFinished, by GetStatus, or by both.
class PendingStep {
 public:
  using Clock = std::chrono::steady_clock;

  /// Resets the state. Must be called before DoStep, because stepFinished may be called before DoStep returns.
  void begin();
  /// Must be called when DoStep has returned fmiPending.
  void continues();
  /// Must be called by the callback stepFinished. May be called from any thread.
  void finished(int status);
  /// Waits until the step ends, and returns its status. Returns fmiPending if `cancel` becomes true or `until` is
  /// reached. Queries the FMU by `status_of_fmu`, first after 20 us and later every 2 ms. Only the result of the query
  /// ends the step, because a late callback may belong to an earlier step. There are two exceptions in which a callback
  /// ends the step: the query returns nullopt; or as many callbacks as pending steps have occurred, and the query still
  /// reports fmiPending after kLongestDenial.
  int wait(const std::atomic<bool>& cancel, const std::function<std::optional<int>()>& status_of_fmu,
           Clock::time_point until = Clock::time_point::max());
  /// True if GetStatus has reported fmiPending although callbacks had reported the end of the step. In this case,
  /// GetStatus is not called again.
  bool is_status_ignored() const { return is_status_ignored_; }

 private:
  static constexpr std::chrono::seconds kLongestDenial{2};

  bool is_denied();

  std::mutex mutex_;
  std::condition_variable over_;
  std::optional<int> status_;
  std::uint64_t steps_ = 0;      // number of pending steps so far
  std::uint64_t callbacks_ = 0;  // number of callbacks for these steps, including late callbacks
  Clock::time_point last_callback_;
  bool is_status_ignored_ = false;  // used only by the stepping thread
};

}  // namespace mebots::master
