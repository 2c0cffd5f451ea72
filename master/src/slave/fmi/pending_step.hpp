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

/// A step of FMI 1.0 or 2.0 for which DoStep has returned Pending. The FMU reports the end of the step by the callback
/// stepFinished, by GetStatus, or by both.
class PendingStep {
 public:
  using Clock = std::chrono::steady_clock;

  /// Must be called before DoStep, because the FMU may call stepFinished before DoStep returns.
  void begin();
  /// Must be called after DoStep has returned Pending.
  void continues();
  /// Must be called by the callback stepFinished, from any thread.
  void finished(int status);
  /// Waits for the end of the step and returns its status. Returns Pending if `cancel` becomes true or at the time
  /// `until`. Calls `status_of_fmu` after 20 us, and later every 2 ms, to query GetStatus. A callback alone does not
  /// end the wait, because it may belong to an earlier step. A callback is accepted if `status_of_fmu` returns nullopt.
  /// It is also accepted if all pending steps have had a callback and GetStatus still reports Pending after
  /// kLongestDenial.
  int wait(const std::atomic<bool>& cancel, const std::function<std::optional<int>()>& status_of_fmu,
           Clock::time_point until = Clock::time_point::max());
  /// True if GetStatus has reported Pending although callbacks had reported the end of the step. GetStatus is then not
  /// called again.
  bool is_status_ignored() const { return is_status_ignored_; }

 private:
  static constexpr std::chrono::seconds kLongestDenial{2};

  bool is_denied();

  std::mutex mutex_;
  std::condition_variable over_;
  std::optional<int> status_;
  std::uint64_t steps_ = 0;
  std::uint64_t callbacks_ = 0;  // number of callbacks for pending steps, including late callbacks
  Clock::time_point last_callback_;
  bool is_status_ignored_ = false;  // for the stepping thread only
};

}  // namespace mebots::master
