// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slave/fmi/continuous_states.hpp"
#include "slave/fmi/fmi3_instance.hpp"
#include "solver/continuous_instance.hpp"

#include <string>
#include <vector>

namespace mebots::master {

/// A model exchange instance of FMI 3.0 in this process. A solver advances it in time.
class Fmi3ModelExchange final : public Fmi3Instance, public ContinuousInstance {
 public:
  Fmi3ModelExchange(std::string name, std::shared_ptr<Fmu> fmu,
                    std::shared_ptr<const modeldesc::ModelDescription> model,
                    const modeldesc::StructuralValues& structural, std::vector<std::string> log_categories,
                    MessageSink& messages, const TimeGrid& grid = {});

  const std::string& name() const override { return Fmi3Instance::name(); }
  /// Exits initialization mode. Throws Error if the library reports other numbers of states or event indicators than
  /// the description.
  void exit_initialization() override;
  StepResult step(std::int64_t start_ns, std::int64_t duration_ns) override;

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
  DiscreteUpdate update_discrete_states() override { return update_event(); }
  void enter_continuous_time_mode() override;
  bool needs_completed_step() const override;
  CompletedStep completed_step() override;

  ClockInstance* clocks() override { return this; }

  bool has_directional_derivatives() const override;
  std::span<const ValueReference> state_references() const override { return continuous_.references; }
  std::span<const ValueReference> derivative_references() const override { return continuous_.derivatives; }
  void directional_derivatives(std::span<const ValueReference> unknowns, std::span<const ValueReference> knowns,
                               std::span<const double> seed, std::span<double> change) override;

 private:
  Evaluation evaluated(int status, const char* function);
  void check_count(const char* function, std::size_t in_library, std::size_t described, std::string_view what);

  ContinuousStates continuous_;
};

}  // namespace mebots::master
