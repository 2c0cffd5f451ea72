// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/fmu_kind.hpp"
#include "slave/fmi/fmu_states.hpp"
#include "slave/fmi/instance_calls.hpp"
#include "slave/fmi/pending_step.hpp"
#include "slave/fmi/step_calls.hpp"
#include "slave/slave.hpp"

#include <atomic>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master {

/// An instance of FMI 2.0 in this process: a co-simulation instance, or the base of Fmi2ModelExchange.
class Fmi2Slave : public Slave {
 public:
  /// Creates the instance. For the parameters, see InstanceCalls.
  Fmi2Slave(std::string name, std::shared_ptr<Fmu> fmu, std::vector<std::string> log_categories, MessageSink& messages,
            const TimeGrid& grid = {})
      : Fmi2Slave(FmuKind::co_simulation, std::move(name), std::move(fmu), std::move(log_categories), messages, grid) {}
  ~Fmi2Slave() override;
  Fmi2Slave(const Fmi2Slave&) = delete;
  Fmi2Slave& operator=(const Fmi2Slave&) = delete;

  const std::string& name() const override { return calls_.name(); }
  const modeldesc::ModelDescription& description() const override { return calls_.description(); }

  void setup_experiment(const Experiment& experiment) override;
  void enter_initialization() override;
  void exit_initialization() override;
  StepResult step(std::int64_t start_ns, std::int64_t duration_ns) override;
  StepResult finish_step(const std::atomic<bool>& cancel) override {
    return steps_.is_under_way() ? steps_.finish(cancel) : Slave::finish_step(cancel);
  }
  void terminate() override;
  std::optional<std::string> free_instance() override;

  std::uint32_t output_derivative_order() const override;
  bool takes_input_derivatives() const override;
  void get_output_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                              std::span<double> values) override;
  void set_input_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                             std::span<const double> values) override;

  void get_reals(std::span<const ValueReference> references, std::span<double> values) override;
  void get_integers(std::span<const ValueReference> references, std::span<std::int64_t> values) override;
  void get_booleans(std::span<const ValueReference> references, std::span<std::int64_t> values) override;
  void get_strings(std::span<const ValueReference> references, std::span<std::string> values) override;
  void set_reals(std::span<const ValueReference> references, std::span<const double> values) override;
  void set_integers(std::span<const ValueReference> references, std::span<const std::int64_t> values) override;
  void set_booleans(std::span<const ValueReference> references, std::span<const std::int64_t> values) override;
  void set_strings(std::span<const ValueReference> references, std::span<const std::string> values) override;

  std::unique_ptr<SlaveState> save_state() override { return states_.save(); }
  void restore_state(const SlaveState& state) override { states_.restore(state); }
  std::vector<std::byte> serialize(const SlaveState& state) override { return states_.serialize(state); }
  std::unique_ptr<SlaveState> deserialize(std::span<const std::byte> bytes) override {
    return states_.deserialize(bytes);
  }

 protected:
  Fmi2Slave(FmuKind kind, std::string name, std::shared_ptr<Fmu> fmu, std::vector<std::string> log_categories,
            MessageSink& messages, const TimeGrid& grid);

  const Fmi2Functions& functions() const { return *functions_; }
  InstanceCalls& calls() { return calls_; }
  FmuStates<Fmi2Functions>& states() { return states_; }

 private:
  std::span<const std::int32_t> narrowed(std::span<const std::int64_t> values);

  const Fmi2Functions* functions_;
  std::vector<const char*> texts_;
  std::vector<std::int32_t> numbers_;  // buffer for the current call

  PendingStep pending_;

  InstanceCalls calls_;  // must be destroyed before the members that callbacks use
  StepCalls<Fmi2StepTypes> steps_;
  FmuStates<Fmi2Functions> states_;
};

}  // namespace mebots::master
