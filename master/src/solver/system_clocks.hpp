// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>

namespace mebots::master {

/// Two times are considered equal if they differ by less than this. It is half the resolution of the master's clock.
constexpr double kSameTime_s = 0.5e-9;

/// The clocks of the members of a system (FMI 3.0). Clocks tick at instants in event mode. An instant begins with the
/// ticks of the clocks that are due, and ends with the update of the discrete states.
class SystemClocks {
 public:
  virtual ~SystemClocks() = default;

  /// The next tick of a member's clock [s]. The time is infinite if no tick is scheduled.
  struct Tick {
    double time_s = std::numeric_limits<double>::infinity();
    std::size_t member = 0;
  };
  virtual Tick next_tick() const = 0;
  /// Makes the clocks that are due tick. Returns true if a clock was due.
  virtual bool begin_instant(double time_s) = 0;
  /// Propagates ticks, and values of clocked variables, along the connections until nothing changes. Returns true if a
  /// clock has started to tick or an input has changed.
  virtual bool propagate(double time_s) = 0;
  /// These functions must be called directly before and after a member updates its discrete states.
  virtual void before_update(std::size_t member) = 0;
  virtual void after_update(std::size_t member, double time_s) = 0;
};

}  // namespace mebots::master
