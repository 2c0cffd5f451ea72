// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/statistics.hpp"
#include "slave/access_slave.hpp"

#include <chrono>

namespace mebots::master {

/// Counts the calls to the wrapped slave and measures their wall time.
class TimedSlave final : public AccessSlave {
 public:
  /// `statistics` must outlive the slave.
  TimedSlave(std::unique_ptr<Slave> inner, InstanceStatistics& statistics)
      : AccessSlave(std::move(inner)), statistics_(&statistics) {}

  void setup_experiment(const Experiment& experiment) override {
    timed([&] { inner().setup_experiment(experiment); });
  }
  void enter_initialization() override {
    timed([&] { inner().enter_initialization(); });
  }
  void exit_initialization() override {
    timed([&] { inner().exit_initialization(); });
  }
  StepResult step(std::int64_t start_ns, std::int64_t duration_ns) override {
    StepResult result;
    const double time_s = timed([&] { result = inner().step(start_ns, duration_ns); });
    ++statistics_->steps;
    statistics_->step_time_s += time_s;
    if (time_s > statistics_->slowest_s) {
      statistics_->slowest_s = time_s;
      statistics_->slowest_at_ns = start_ns;
    }
    return result;
  }
  StepResult finish_step(const std::atomic<bool>& cancel) override {
    StepResult result;
    statistics_->step_time_s += timed([&] { result = inner().finish_step(cancel); });
    return result;
  }
  void terminate() override {
    timed([&] { inner().terminate(); });
  }
  void get_output_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                              std::span<double> values) override {
    timed([&] { inner().get_output_derivatives(references, orders, values); });
  }
  void set_input_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                             std::span<const double> values) override {
    timed([&] { inner().set_input_derivatives(references, orders, values); });
  }

 private:
  void get(ValueKind kind, std::span<const ValueReference> references, Destination values) override {
    timed([&] { pass_get(kind, references, values); });
  }
  void set(ValueKind kind, std::span<const ValueReference> references, Source values) override {
    timed([&] { pass_set(kind, references, values); });
  }

  /// Calls `work`, counts the call and returns its wall time in seconds.
  template <typename Work>
  double timed(Work work) {
    const auto start = std::chrono::steady_clock::now();
    ++statistics_->calls;
    work();
    const double time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    statistics_->time_s += time_s;
    return time_s;
  }

  InstanceStatistics* statistics_;
};

}  // namespace mebots::master
