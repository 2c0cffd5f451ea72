// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slave/fmi/fmi3_values.hpp"
#include "slave/fmi/fmu_states.hpp"
#include "slave/fmi/instance_calls.hpp"
#include "slave/slave.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mebots::master {

/// A co-simulation instance of FMI 3.0 inside this process. An FMU that has an event mode runs with it. Events within a
/// step (early returns) are handled here, and the step goes on to its end.
class Fmi3Slave final : public Slave {
 public:
  /// Instantiates, and sets structural parameters in configuration mode. `model` is fmu->model(structural). The other
  /// arguments are those of InstanceCalls.
  Fmi3Slave(std::string name, std::shared_ptr<Fmu> fmu, std::shared_ptr<const modeldesc::ModelDescription> model,
            const modeldesc::StructuralValues& structural, std::vector<std::string> log_categories,
            MessageSink& messages, const TimeGrid& grid = {});
  ~Fmi3Slave() override;
  Fmi3Slave(const Fmi3Slave&) = delete;
  Fmi3Slave& operator=(const Fmi3Slave&) = delete;

  const std::string& name() const override { return calls_.name(); }
  const modeldesc::ModelDescription& description() const override { return *model_; }

  void setup_experiment(const Experiment& experiment) override { experiment_ = experiment; }
  void enter_initialization() override;
  void exit_initialization() override;
  StepResult step(std::int64_t start_ns, std::int64_t duration_ns) override;
  void terminate() override;
  std::optional<std::string> free_instance() override;

  std::uint32_t output_derivative_order() const override;
  void get_output_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                              std::span<double> values) override;

  void get_reals(std::span<const ValueReference> references, std::span<double> values) override {
    values_.get(references, values);
  }
  void get_integers(std::span<const ValueReference> references, std::span<std::int64_t> values) override {
    values_.get(ValueKind::integer, references, values);
  }
  void get_booleans(std::span<const ValueReference> references, std::span<std::int64_t> values) override {
    values_.get(ValueKind::boolean, references, values);
  }
  void get_strings(std::span<const ValueReference> references, std::span<std::string> values) override {
    values_.get(ValueKind::string, references, values);
  }
  void get_binaries(std::span<const ValueReference> references, std::span<std::string> values) override {
    values_.get(ValueKind::binary, references, values);
  }
  void set_reals(std::span<const ValueReference> references, std::span<const double> values) override {
    values_.set(references, values);
  }
  void set_integers(std::span<const ValueReference> references, std::span<const std::int64_t> values) override {
    values_.set(ValueKind::integer, references, values);
  }
  void set_booleans(std::span<const ValueReference> references, std::span<const std::int64_t> values) override {
    values_.set(ValueKind::boolean, references, values);
  }
  void set_strings(std::span<const ValueReference> references, std::span<const std::string> values) override {
    values_.set(ValueKind::string, references, values);
  }
  void set_binaries(std::span<const ValueReference> references, std::span<const std::string> values) override {
    values_.set(ValueKind::binary, references, values);
  }

  std::unique_ptr<SlaveState> save_state() override { return states_.save(); }
  void restore_state(const SlaveState& state) override { states_.restore(state); }
  std::vector<std::byte> serialize(const SlaveState& state) override { return states_.serialize(state); }
  std::unique_ptr<SlaveState> deserialize(std::span<const std::byte> bytes) override {
    return states_.deserialize(bytes);
  }

 private:
  /// What fmi3DoStep returned.
  struct Outcome {
    bool event = false;
    bool terminate = false;
    bool early = false;
    double time_s = 0;
  };

  void configure(const modeldesc::StructuralValues& structural);
  std::optional<Outcome> do_step(double start_s, double end_s, bool never_back);
  bool handle_event();
  StepResult terminated(double time_s) const;

  const Fmi3Functions* functions_;
  std::shared_ptr<const modeldesc::ModelDescription> model_;
  bool uses_events_;
  Experiment experiment_;

  InstanceCalls calls_;
  Fmi3Values values_;
  FmuStates<Fmi3Functions> states_;
};

}  // namespace mebots::master
