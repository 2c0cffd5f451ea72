// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slave/slave.hpp"

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>

namespace mebots::master {

/// A step of FMI 1.0 or 2.0 that continues in the FMU after DoStep has returned fmiPending. The FMU reports its end by
/// the callback stepFinished, by GetStatus, or by both.
class PendingStep {
 public:
  /// Resets the state. Call it before DoStep, because the callback may precede its return.
  void begin();
  /// Notes that the step continues, and returns the result of Slave::step().
  StepResult continues();
  bool is_under_way() const { return is_under_way_; }
  /// The callback. From any thread.
  void finished(int status);
  /// Waits for the end of the step and returns its status; fmiPending if `cancel` becomes true first. Queries the
  /// status by `ask`, every 20 us at first and every 2 ms later.
  int wait(const std::atomic<bool>& cancel, const std::function<int()>& ask);
  /// Returns the result of Slave::finish_step() for a cancelled step.
  static StepResult cancelled();

 private:
  int wait_for_status(const std::atomic<bool>& cancel, const std::function<int()>& ask);

  bool is_under_way_ = false;
  std::mutex mutex_;
  std::condition_variable over_;
  std::optional<int> status_;
};

}  // namespace mebots::master
