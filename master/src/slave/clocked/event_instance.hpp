// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/clock_instance.hpp"
#include "solver/continuous_instance.hpp"

#include <optional>
#include <string>

namespace mebots::master {

/// The result of one call of a step function.
struct StepEnd {
  bool event = false;      ///< the instance requires event mode
  bool terminate = false;  ///< the instance ends the simulation
  double time_s = 0;       ///< after an early return, less than the requested end
};

/// A co-simulation instance (FMI 3.0) whose caller handles events and clocks. After initialisation, the instance is in
/// event mode. All calls throw Error if the instance fails.
class EventInstance {
 public:
  virtual ~EventInstance() = default;

  virtual const std::string& name() const = 0;

  /// In step mode, takes a step. Returns empty if the instance discards the step.
  virtual std::optional<StepEnd> step_until(double start_s, double end_s) = 0;
  virtual void enter_event_mode() = 0;
  virtual void enter_step_mode() = 0;

  virtual ClockInstance& clocks() = 0;
  virtual DiscreteUpdate update_discrete_states() = 0;
};

}  // namespace mebots::master
