// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi1/library.hpp"
#include "mebots/fmi2/library.hpp"
#include "slave/fmi/instance_calls.hpp"
#include "slave/fmi/pending_step.hpp"
#include "slave/slave.hpp"

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

namespace mebots::master {

struct Fmi1StepTypes {
  using Functions = fmi1::Functions;
  using Status = fmiStatus;
  using Boolean = fmiBoolean;
  static constexpr auto kDoStepStatus = fmiDoStepStatus;
  static constexpr auto kLastSuccessfulTime = fmiLastSuccessfulTime;
  static constexpr const char* kDoStep = "fmiDoStep";
  static constexpr const char* kGetStatus = "fmiGetStatus";
  static constexpr const char* kGetRealStatus = "fmiGetRealStatus";
  static constexpr const char* kCancelStep = "fmiCancelStep";
};

struct Fmi2StepTypes {
  using Functions = fmi2::Functions;
  using Status = fmi2Status;
  using Boolean = fmi2Boolean;
  static constexpr auto kDoStepStatus = fmi2DoStepStatus;
  static constexpr auto kLastSuccessfulTime = fmi2LastSuccessfulTime;
  static constexpr const char* kDoStep = "fmi2DoStep";
  static constexpr const char* kGetStatus = "fmi2GetStatus";
  static constexpr const char* kGetRealStatus = "fmi2GetRealStatus";
  static constexpr const char* kCancelStep = "fmi2CancelStep";
};

/// Performs the steps of a co-simulation instance of FMI 1.0 or 2.0. The FMU may complete a step after DoStep has
/// returned.
template <typename Types>
class StepCalls {
 public:
  /// `has_callback` is true if the FMU can call stepFinished. The other arguments must outlive this object.
  StepCalls(InstanceCalls& calls, PendingStep& pending, const typename Types::Functions& functions, bool has_callback)
      : calls_(&calls), pending_(&pending), functions_(&functions), has_callback_(has_callback) {}

  /// Performs a step like Slave::step(). `last_argument` is the last argument of DoStep.
  StepResult step(std::int64_t start_ns, std::int64_t duration_ns, typename Types::Boolean last_argument);
  /// Finishes a pending step like Slave::finish_step(). If the FMU cannot cancel the step, waits for its end for at
  /// most one second. After that time, abandons the instance and throws InterruptedError.
  StepResult finish(const std::atomic<bool>& cancel);
  /// Ends a pending step before the instance is freed. Abandons the instance if the step does not end or the FMU fails.
  /// If the FMU fails, also throws SlaveError.
  void end();
  bool is_under_way() const { return is_under_way_; }

 private:
  StepResult ended(int status);
  [[noreturn]] void fail_unknown_end();
  void report_denial();
  std::string cancel_step();
  bool is_over_soon(int& status);
  std::optional<int> queried_status();

  InstanceCalls* calls_;
  PendingStep* pending_;
  const typename Types::Functions* functions_;
  bool has_callback_;
  bool is_under_way_ = false;
  bool is_denial_reported_ = false;
  std::int64_t end_ns_ = 0;
  std::uint64_t dropped_ends_ = 0;  // number of ignored callbacks before the step
};

extern template class StepCalls<Fmi1StepTypes>;
extern template class StepCalls<Fmi2StepTypes>;

}  // namespace mebots::master
