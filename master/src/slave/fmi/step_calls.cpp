// SPDX-License-Identifier: Apache-2.0
#include "slave/fmi/step_calls.hpp"

#include "base/signal_guard.hpp"
#include "mebots/assert.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

namespace mebots::master {
namespace {

/// The maximum wait for the end of a step that the FMU cannot cancel.
constexpr std::chrono::seconds kLongestEnd{1};

}  // namespace

template <typename Types>
StepResult StepCalls<Types>::step(std::int64_t start_ns, std::int64_t duration_ns,
                                  typename Types::Boolean last_argument) {
  calls_->set_time_ns(start_ns);
  end_ns_ = start_ns + duration_ns;
  if (has_callback_) {
    pending_->begin();
    dropped_ends_ = calls_->target().dropped_step_ends();
  }
  const int status = calls_->watched_step(Types::kDoStep, [&]() -> int {
    return calls_->call(Types::kDoStep, functions_->do_step, calls_->grid().time_s(start_ns),
                        calls_->grid().length_s(start_ns, end_ns_), last_argument);
  });
  if (status != InstanceCalls::kPending) return ended(status);
  if (functions_->get_status == nullptr && !has_callback_) {
    calls_->fail(Types::kDoStep,
                 fmt::format("returned {}, and the end of the step cannot be detected: the FMU has no {}, and "
                             "canRunAsynchronuously is false",
                             calls_->name_of_status(status), Types::kGetStatus));
  }
  is_under_way_ = true;
  pending_->continues();
  StepResult result;
  result.done = false;
  result.pending = true;
  return result;
}

template <typename Types>
void StepCalls<Types>::fail_unknown_end() {
  calls_->fail(Types::kDoStep,
               fmt::format("returned {}, and the end of the step cannot be detected: the FMU has no {}, and "
                           "stepFinished was called with an unknown instance. Run the instance in a process of "
                           "its own (\"process\": \"own\")",
                           calls_->name_of_status(InstanceCalls::kPending), Types::kGetStatus));
}

/// Queries the status of a pending step. Returns nullopt if the FMU does not report it.
template <typename Types>
std::optional<int> StepCalls<Types>::queried_status() {
  if (functions_->get_status == nullptr) {
    if (calls_->target().dropped_step_ends() != dropped_ends_) fail_unknown_end();
    return std::nullopt;
  }
  auto status = static_cast<typename Types::Status>(InstanceCalls::kPending);
  const int returned = calls_->call(Types::kGetStatus, functions_->get_status, Types::kDoStepStatus, &status);
  if (returned == InstanceCalls::kError || returned == InstanceCalls::kFatal)
    calls_->check(returned, Types::kGetStatus);
  if (returned != InstanceCalls::kOk) return std::nullopt;
  return status;
}

template <typename Types>
StepResult StepCalls<Types>::finish(const std::atomic<bool>& cancel) {
  MEBOTS_ASSERT(is_under_way_);
  int status = pending_->wait(cancel, [this] { return queried_status(); });
  report_denial();
  std::string obstacle;
  if (status == InstanceCalls::kPending) {
    obstacle = cancel_step();
    if (obstacle.empty()) {
      is_under_way_ = false;
      StepResult result;
      result.done = false;
      result.cancelled = true;
      return result;
    }
  }
  if (status != InstanceCalls::kPending || is_over_soon(status)) {
    is_under_way_ = false;
    return ended(status);
  }
  calls_->abandon();
  throw InterruptedError(fmt::format("instance '{}' is neither terminated nor freed: its step continues, and {}",
                                     calls_->name(), obstacle));
}

template <typename Types>
void StepCalls<Types>::report_denial() {
  if (!pending_->is_status_ignored() || std::exchange(is_denial_reported_, true)) return;
  calls_->warn(
      fmt::format("{} reports a pending step after the FMU called stepFinished; from now on, stepFinished alone "
                  "ends a step",
                  Types::kGetStatus));
}

/// Cancels a step. Returns the reason if this fails; otherwise an empty text.
template <typename Types>
std::string StepCalls<Types>::cancel_step() {
  if (functions_->cancel_step == nullptr) return fmt::format("the FMU has no {}", Types::kCancelStep);
  const int status = calls_->call(Types::kCancelStep, functions_->cancel_step);
  if (status == InstanceCalls::kFatal) calls_->check(status, Types::kCancelStep);
  if (status == InstanceCalls::kOk || status == InstanceCalls::kWarning) return "";
  return fmt::format("{} returned {}", Types::kCancelStep, calls_->name_of_status(status));
}

template <typename Types>
bool StepCalls<Types>::is_over_soon(int& status) {
  const auto until = PendingStep::Clock::now() + kLongestEnd;
  status = pending_->wait(
      kNeverInterrupted, [this] { return queried_status(); }, until);
  return status != InstanceCalls::kPending;
}

template <typename Types>
void StepCalls<Types>::end() {
  if (!std::exchange(is_under_way_, false)) return;
  try {
    int status = InstanceCalls::kPending;
    if (!cancel_step().empty() && !is_over_soon(status)) calls_->abandon();
  } catch (...) {
    calls_->abandon();
    throw;
  }
}

template <typename Types>
StepResult StepCalls<Types>::ended(int status) {
  if (status != InstanceCalls::kDiscard) {
    calls_->check(status, Types::kDoStep);
    calls_->set_time_ns(end_ns_);  // for messages after the step
    return {};
  }
  calls_->deliver_held();
  StepResult result;
  result.done = false;
  if constexpr (requires { functions_->get_boolean_status; }) {
    fmi2Boolean terminated = fmi2False;
    if (functions_->get_boolean_status != nullptr &&
        calls_->call("fmi2GetBooleanStatus", functions_->get_boolean_status, fmi2Terminated, &terminated) == fmi2OK) {
      result.terminated = terminated != fmi2False;
    }
  }
  double last_successful_s = 0;
  if (functions_->get_real_status != nullptr &&
      calls_->call(Types::kGetRealStatus, functions_->get_real_status, Types::kLastSuccessfulTime,
                   &last_successful_s) == InstanceCalls::kOk) {
    result.last_successful_s = last_successful_s;
  }
  result.messages = calls_->last_messages();
  return result;
}

template class StepCalls<Fmi1StepTypes>;
template class StepCalls<Fmi2StepTypes>;

}  // namespace mebots::master
