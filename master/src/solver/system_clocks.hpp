// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>

namespace mebots::master {

/// Times with a smaller difference are equal [s]. Half of the master's resolution of one nanosecond.
constexpr double kSameTime_s = 0.5e-9;

/// The clocks of a system's members (FMI 3.0). Clocks tick in event mode. An instant begins with the ticks that are
/// due, and ends with the update of the discrete states.
class SystemClocks {
 public:
  virtual ~SystemClocks() = default;

  /// The next tick of a member's clock. The time is infinite if no tick is scheduled.
  struct Tick {
    double time_s = std::numeric_limits<double>::infinity();
    std::size_t member = 0;
  };
  virtual Tick next_tick() const = 0;
  /// Activates the clocks whose next tick is scheduled for `time_s`. Returns true if there is such a clock.
  virtual bool begin_instant(double time_s) = 0;
  /// Propagates ticks and values of clocked variables along the connections until nothing changes. Returns true if
  /// another clock ticked or an input changed.
  virtual bool propagate(double time_s) = 0;
  /// Must be called directly before and after a member updates its discrete states.
  virtual void before_update(std::size_t member) = 0;
  virtual void after_update(std::size_t member, double time_s) = 0;
};

}  // namespace mebots::master
