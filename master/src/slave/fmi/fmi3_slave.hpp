// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slave/clocked/event_instance.hpp"
#include "slave/fmi/fmi3_instance.hpp"
#include "slave/fmi/intermediate_inputs.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mebots::master {

/// Selects the code that handles the events of an instance.
enum class EventHandler : std::uint8_t {
  /// The slave handles events in exit_initialization() and step(). After an early return, step() continues to the end
  /// of the step.
  slave,
  group,  ///< the caller handles events with the functions of EventInstance, and does not call step()
};

/// A co-simulation instance of FMI 3.0 in this process. Uses the event mode if the FMU supports it.
class Fmi3Slave final : public Fmi3Instance, public EventInstance {
 public:
  /// Creates the instance. For the other parameters, see Fmi3Instance.
  Fmi3Slave(std::string name, std::shared_ptr<Fmu> fmu, std::shared_ptr<const modeldesc::ModelDescription> model,
            const modeldesc::StructuralValues& structural, std::vector<std::string> log_categories,
            MessageSink& messages, const TimeGrid& grid = {}, EventHandler handler = EventHandler::slave);

  const std::string& name() const override { return Fmi3Instance::name(); }
  void exit_initialization() override;
  StepResult step(std::int64_t start_ns, std::int64_t duration_ns) override;

  /// True if the FMU accepts inputs within a step (intermediate update). FMI 3.0 has no function that sets derivatives.
  /// The slave therefore computes the inputs within a step from the derivatives.
  bool takes_input_derivatives() const override { return !intermediate_inputs_.empty(); }
  void set_input_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                             std::span<const double> values) override;
  void set_reals(std::span<const ValueReference> references, std::span<const double> values) override;

  std::uint32_t output_derivative_order() const override;
  void get_output_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                              std::span<double> values) override;

  std::optional<StepEnd> step_until(double start_s, double end_s) override;
  void enter_event_mode() override;
  void enter_step_mode() override;
  ClockInstance& clocks() override { return *this; }
  DiscreteUpdate update_discrete_states() override { return update_event(); }

 private:
  bool uses_events() const { return description().co_simulation->has_event_mode; }
  std::optional<StepEnd> do_step(double start_s, double end_s, bool never_back);
  bool handle_event();
  StepResult terminated(double time_s) const;

  void set_intermediate_inputs(double time_s) noexcept;

  EventHandler handler_;
  IntermediateInputs intermediate_inputs_;
  int intermediate_status_ = InstanceCalls::kOk;  // worst status of all calls from a callback in the current step
};

}  // namespace mebots::master
