// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi1/library.hpp"
#include "slave/fmi/instance_calls.hpp"
#include "slave/fmi/negated_values.hpp"
#include "slave/fmi/pending_step.hpp"
#include "slave/fmi/step_calls.hpp"
#include "slave/slave.hpp"

#include <atomic>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mebots::master {

/// A co-simulation instance of FMI 1.0 in this process. FMI 1.0 initializes an instance in one call,
/// fmiInitializeSlave. Outputs can be read only after this call. If an input changes between enter_initialization() and
/// exit_initialization(), this class creates and initializes the instance again before the next value is read. The new
/// instance receives all values that were set. Inputs from connections therefore take effect during initialization, as
/// in FMI 2.0.
class Fmi1Slave final : public Slave {
 public:
  /// Creates the instance. For the parameters, see InstanceCalls.
  Fmi1Slave(std::string name, std::shared_ptr<Fmu> fmu, std::vector<std::string> log_categories, MessageSink& messages,
            const TimeGrid& grid = {});
  ~Fmi1Slave() override;
  Fmi1Slave(const Fmi1Slave&) = delete;
  Fmi1Slave& operator=(const Fmi1Slave&) = delete;

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

  // These functions throw Error, because FMI 1.0 cannot save states.
  std::unique_ptr<SlaveState> save_state() override;
  void restore_state(const SlaveState& state) override;
  std::vector<std::byte> serialize(const SlaveState& state) override;
  std::unique_ptr<SlaveState> deserialize(std::span<const std::byte> bytes) override;

 private:
  enum class Phase { instantiated, initializing, running };
  /// All values that were set before the first step, indexed by the value references of the FMU. Values of negated
  /// aliases are stored with the sign that the FMU uses.
  struct StartValues {
    std::map<ValueReference, double> reals;
    std::map<ValueReference, fmiInteger> integers;
    std::map<ValueReference, fmiBoolean> booleans;
    std::map<ValueReference, std::string> strings;
  };

  void* instantiate();
  void initialize();
  void initialize_anew();
  void set_start_values();
  /// Stores values that are set before the end of initialization. Returns true if the FMU must not receive the values
  /// now.
  template <typename Value, typename Get>
  bool keep(std::map<ValueReference, Value>& kept, std::span<const ValueReference> references,
            std::span<const Value> values, Get get);
  template <typename Value, typename Function>
  Value present(const char* name, Function* function, ValueReference reference);

  const Fmi1Functions* functions_;
  fmiCallbackFunctions callbacks_{};
  Experiment experiment_;
  Phase phase_ = Phase::instantiated;
  StartValues start_;
  bool is_stale_ = false;  // true if the FMU was not initialized with all values of start_
  NegatedValues negated_;

  // Buffers for the current call.
  std::vector<const char*> texts_;
  std::vector<fmiInteger> numbers_;
  std::vector<fmiBoolean> flags_;
  std::vector<double> reals_;

  PendingStep pending_;
  InstanceCalls calls_;  // must be destroyed before the members that callbacks use
  StepCalls<Fmi1StepTypes> steps_;
};

}  // namespace mebots::master
