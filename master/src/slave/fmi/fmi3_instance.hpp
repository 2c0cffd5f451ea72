// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/fmu_kind.hpp"
#include "slave/fmi/fmi3_values.hpp"
#include "slave/fmi/fmu_states.hpp"
#include "slave/fmi/instance_calls.hpp"
#include "slave/slave.hpp"
#include "solver/clock_instance.hpp"
#include "solver/continuous_instance.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mebots::master {

/// An instance of FMI 3.0 in this process. Derived classes define how the instance advances in time.
class Fmi3Instance : public Slave, public ClockInstance {
 public:
  ~Fmi3Instance() override;
  Fmi3Instance(const Fmi3Instance&) = delete;
  Fmi3Instance& operator=(const Fmi3Instance&) = delete;

  const std::string& name() const override { return calls_.name(); }
  const modeldesc::ModelDescription& description() const override { return *model_; }

  void setup_experiment(const Experiment& experiment) override { experiment_ = experiment; }
  void enter_initialization() override;
  void exit_initialization() override;
  void terminate() override;
  std::optional<std::string> free_instance() override;

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

  bool ticks(ValueReference clock) override;
  void tick(ValueReference clock) override;
  std::optional<double> new_interval(ValueReference clock) override;
  double shift(ValueReference clock) override;

  std::unique_ptr<SlaveState> save_state() override { return states_.save(); }
  void restore_state(const SlaveState& state) override { states_.restore(state); }
  std::vector<std::byte> serialize(const SlaveState& state) override { return states_.serialize(state); }
  std::unique_ptr<SlaveState> deserialize(std::span<const std::byte> bytes) override {
    return states_.deserialize(bytes);
  }

 protected:
  /// Creates the instance, and sets its structural parameters in configuration mode. `model` must be
  /// fmu->model(structural). For the other parameters, see InstanceCalls.
  Fmi3Instance(FmuKind kind, std::string name, std::shared_ptr<Fmu> fmu,
               std::shared_ptr<const modeldesc::ModelDescription> model, const modeldesc::StructuralValues& structural,
               std::vector<std::string> log_categories, MessageSink& messages, const TimeGrid& grid);

  /// Updates the discrete states of the FMU, which must be in event mode.
  DiscreteUpdate update_event();

  const Fmi3Functions& functions() const { return *functions_; }
  /// True if the FMU can call functions of the master within a step. False under wine, where the FMU is in another
  /// process.
  bool can_call_back() const { return !calls_.fmu().runs_under_wine(); }
  InstanceCalls& calls() { return calls_; }
  const InstanceCalls& calls() const { return calls_; }
  Fmi3Values& values() { return values_; }
  FmuStates<Fmi3Functions>& states() { return states_; }

 private:
  void* instantiate(FmuKind kind, const char* resources);
  void choose_log_categories();
  void configure(const modeldesc::StructuralValues& structural);

  const Fmi3Functions* functions_;
  std::shared_ptr<const modeldesc::ModelDescription> model_;
  Experiment experiment_;

  InstanceCalls calls_;
  Fmi3Values values_;
  FmuStates<Fmi3Functions> states_;
};

}  // namespace mebots::master
