// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/value_kind.hpp"

#include <optional>
#include <string>

namespace mebots::master {

/// The clocks of an FMI 3.0 instance (co-simulation or model exchange). The caller determines when they tick. All calls
/// throw Error if the instance fails.
class ClockInstance {
 public:
  virtual ~ClockInstance() = default;

  virtual const std::string& name() const = 0;

  /// In event mode, returns true if an output clock ticks at this instant.
  virtual bool ticks(ValueReference clock) = 0;
  /// In event mode, activates an input clock.
  virtual void tick(ValueReference clock) = 0;
  /// Returns the interval until the clock's next tick. Empty if the interval has not changed or is not known yet.
  virtual std::optional<double> new_interval(ValueReference clock) = 0;
  /// In initialisation mode, returns the time of a periodic clock's first tick after the start.
  virtual double shift(ValueReference clock) = 0;
};

}  // namespace mebots::master
