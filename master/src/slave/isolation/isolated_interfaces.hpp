// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slave/clocked/event_instance.hpp"
#include "slave/fmi/continuous_states.hpp"
#include "solver/clock_instance.hpp"
#include "solver/continuous_instance.hpp"

#include "isolated_slave.hpp"

#include <optional>
#include <span>
#include <string>

namespace mebots::master::isolation {

/// An instance with clocks in a separate process.
class IsolatedClocks : public IsolatedSlave, public ClockInstance {
 public:
  using IsolatedSlave::IsolatedSlave;

  const std::string& name() const override { return IsolatedSlave::name(); }
  bool ticks(ValueReference clock) override;
  void tick(ValueReference clock) override;
  std::optional<double> new_interval(ValueReference clock) override;
  double shift(ValueReference clock) override;
};

/// A model exchange instance in a separate process. Each evaluation sends one call and waits for its answer.
class IsolatedModelExchange final : public IsolatedClocks, public ContinuousInstance {
 public:
  IsolatedModelExchange(const ResolvedInstance& instance, MessageSink& messages, const std::atomic<bool>* interrupted,
                        const TimeGrid& grid);

  const std::string& name() const override { return IsolatedClocks::name(); }
  std::size_t state_count() const override { return continuous_.names.size(); }
  std::size_t indicator_count() const override { return description().number_of_event_indicators; }
  std::string state_name(std::size_t state) const override { return continuous_.names[state]; }

  void set_time(double time_s) override;
  void get_states(std::span<double> states) override;
  Evaluation set_states(std::span<const double> states) override;
  Evaluation get_derivatives(std::span<double> derivatives) override;
  Evaluation get_indicators(std::span<double> indicators) override;
  void get_nominals(std::span<double> nominals) override;
  Evaluation get_outputs(std::span<const ValueReference> references, std::span<double> values) override;
  Evaluation set_inputs(std::span<const ValueReference> references, std::span<const double> values) override;

  void enter_event_mode() override;
  DiscreteUpdate update_discrete_states() override;
  void enter_continuous_time_mode() override;
  bool needs_completed_step() const override;
  CompletedStep completed_step() override;

  ClockInstance* clocks() override { return this; }

  bool has_directional_derivatives() const override { return provides_directional_derivatives(); }
  std::span<const ValueReference> state_references() const override { return continuous_.references; }
  std::span<const ValueReference> derivative_references() const override { return continuous_.derivatives; }
  void directional_derivatives(std::span<const ValueReference> unknowns, std::span<const ValueReference> knowns,
                               std::span<const double> seed, std::span<double> change) override;

 private:
  template <typename... Arguments>
  Evaluation get_values(Call call, std::span<double> values, const Arguments&... arguments);
  template <typename... Arguments>
  Evaluation evaluate(Call call, const Arguments&... arguments);

  ContinuousStates continuous_;
};

/// A co-simulation instance with clocks in a separate process.
class IsolatedEventSlave final : public IsolatedClocks, public EventInstance {
 public:
  using IsolatedClocks::IsolatedClocks;

  const std::string& name() const override { return IsolatedClocks::name(); }
  std::optional<StepEnd> step_until(double start_s, double end_s) override;
  void enter_event_mode() override;
  void enter_step_mode() override;
  ClockInstance& clocks() override { return *this; }
  DiscreteUpdate update_discrete_states() override;
};

}  // namespace mebots::master::isolation
