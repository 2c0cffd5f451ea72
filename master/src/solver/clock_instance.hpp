// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/value_kind.hpp"

#include <optional>
#include <string>

namespace mebots::master {

/// The clocks of an FMI 3.0 instance of either kind, whose caller handles them. All calls throw Error if the instance
/// fails.
class ClockInstance {
 public:
  virtual ~ClockInstance() = default;

  virtual const std::string& name() const = 0;

  /// In event mode, returns true if an output clock ticks at this instant.
  virtual bool ticks(ValueReference clock) = 0;
  /// In event mode, activates an input clock.
  virtual void tick(ValueReference clock) = 0;
  /// Returns the interval of a clock until its next tick; empty if it is unchanged or not known yet.
  virtual std::optional<double> new_interval(ValueReference clock) = 0;
  /// In initialisation mode, returns the time of a periodic clock's first tick after the start.
  virtual double shift(ValueReference clock) = 0;
};

}  // namespace mebots::master
