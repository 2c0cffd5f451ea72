// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/value_kind.hpp"
#include "solver/continuous_instance.hpp"

#include <optional>
#include <string>

namespace mebots::master {

/// The end of one call of a step function.
struct StepEnd {
  bool event = false;      ///< the instance needs event mode
  bool terminate = false;  ///< the instance ends the simulation
  double time_s = 0;       ///< before the requested end after an early return
};

/// A co-simulation instance whose events and clocks are handled from outside (FMI 3.0). After initialisation it is in
/// event mode. All calls throw Error if the instance fails.
class EventInstance {
 public:
  virtual ~EventInstance() = default;

  virtual const std::string& name() const = 0;

  /// In step mode. Nothing if the instance discards the step.
  virtual std::optional<StepEnd> step_until(double start_s, double end_s) = 0;
  virtual void enter_event_mode() = 0;
  virtual void enter_step_mode() = 0;

  /// In event mode: whether an output clock ticks at this instant.
  virtual bool ticks(ValueReference clock) = 0;
  /// In event mode: lets an input clock tick.
  virtual void tick(ValueReference clock) = 0;
  /// The interval of a clock until its next tick; nothing if it is as before or not known yet.
  virtual std::optional<double> new_interval(ValueReference clock) = 0;
  /// In initialisation mode: the time of the first tick of a periodic clock after the start.
  virtual double shift(ValueReference clock) = 0;
  virtual DiscreteUpdate update_discrete_states() = 0;
};

}  // namespace mebots::master
