// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/value_kind.hpp"
#include "solver/clock_instance.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace mebots::master {

enum class Evaluation {
  ok,
  recoverable,  ///< failed; may succeed with a smaller solver step
};

/// The result of fmi2NewDiscreteStates, fmi3UpdateDiscreteStates and similar calls.
struct DiscreteUpdate {
  bool needs_another = false;
  bool terminate = false;
  std::optional<double> next_event_s = {};
};

/// The requests of an instance after a completed solver step.
struct CompletedStep {
  bool enter_event_mode = false;
  bool terminate = false;
};

/// A model exchange instance of any FMI version. After initialization, the instance is in event mode. All functions
/// throw Error if the instance fails.
class ContinuousInstance {
 public:
  virtual ~ContinuousInstance() = default;

  virtual const std::string& name() const = 0;
  virtual std::size_t state_count() const = 0;
  virtual std::size_t indicator_count() const = 0;
  /// Returns the name of a state for messages.
  virtual std::string state_name(std::size_t state) const = 0;

  virtual void set_time(double time_s) = 0;
  virtual void get_states(std::span<double> states) = 0;
  virtual Evaluation set_states(std::span<const double> states) = 0;
  virtual Evaluation get_derivatives(std::span<double> derivatives) = 0;
  virtual Evaluation get_indicators(std::span<double> indicators) = 0;
  virtual void get_nominals(std::span<double> nominals) = 0;

  virtual Evaluation get_outputs(std::span<const ValueReference> references, std::span<double> values) = 0;
  virtual Evaluation set_inputs(std::span<const ValueReference> references, std::span<const double> values) = 0;

  virtual void enter_event_mode() = 0;
  virtual DiscreteUpdate update_discrete_states() = 0;
  virtual void enter_continuous_time_mode() = 0;
  virtual bool needs_completed_step() const { return true; }
  virtual CompletedStep completed_step() = 0;

  /// Returns the clocks of an FMI 3.0 instance. Returns null for other FMI versions.
  virtual ClockInstance* clocks() { return nullptr; }

  virtual bool has_directional_derivatives() const { return false; }
  virtual std::span<const ValueReference> state_references() const { return {}; }
  virtual std::span<const ValueReference> derivative_references() const { return {}; }
  /// Computes the change of `unknowns` if `knowns` change by `seed`. Requires has_directional_derivatives().
  virtual void directional_derivatives(std::span<const ValueReference> /*unknowns*/,
                                       std::span<const ValueReference> /*knowns*/, std::span<const double> /*seed*/,
                                       std::span<double> /*change*/) {}
};

}  // namespace mebots::master
