// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/clock_instance.hpp"
#include "solver/continuous_instance.hpp"

#include <optional>
#include <string>

namespace mebots::master {

struct StepEnd {
  bool event = false;      ///< true if the instance requires event mode
  bool terminate = false;  ///< true if the instance ends the simulation
  double time_s = 0;       ///< time that the instance has reached; earlier than requested after an early return
};

/// A co-simulation instance of FMI 3.0 whose events and clocks the caller handles. The instance is in event mode after
/// initialization. All functions throw Error if a call to the FMU fails.
class EventInstance {
 public:
  virtual ~EventInstance() = default;

  virtual const std::string& name() const = 0;

  /// Performs a step in step mode. Returns nullopt if the instance discards the step.
  virtual std::optional<StepEnd> step_until(double start_s, double end_s) = 0;
  virtual void enter_event_mode() = 0;
  virtual void enter_step_mode() = 0;

  virtual ClockInstance& clocks() = 0;
  virtual DiscreteUpdate update_discrete_states() = 0;
};

}  // namespace mebots::master
