// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/value_kind.hpp"

#include <optional>
#include <string>

namespace mebots::master {

/// The interface to the clocks of an FMI 3.0 instance. The caller decides when input clocks tick. All functions throw
/// Error if the instance fails.
class ClockInstance {
 public:
  virtual ~ClockInstance() = default;

  virtual const std::string& name() const = 0;

  /// True if an output clock ticks at this instant. The instance must be in event mode.
  virtual bool ticks(ValueReference clock) = 0;
  /// Activates an input clock at this instant. The instance must be in event mode.
  virtual void tick(ValueReference clock) = 0;
  /// Returns the interval until the next tick of a clock [s]. Returns nullopt if the interval is unchanged or not yet
  /// known.
  virtual std::optional<double> new_interval(ValueReference clock) = 0;
  /// Returns the time from the start to the first tick of a periodic clock [s]. The instance must be in initialization
  /// mode.
  virtual double shift(ValueReference clock) = 0;
};

}  // namespace mebots::master
