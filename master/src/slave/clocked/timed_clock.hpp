// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "solver/clock_instance.hpp"

#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

namespace mebots::master {

/// Computes the ticks of a time-based input clock: periodic, changing or countdown (FMI 3.0.2, section 2.2.8).
class TimedClock {
 public:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  /// `variable` is of type Clock, and must outlive this object.
  explicit TimedClock(const modeldesc::Variable& variable) : variable_(&variable) {}

  const modeldesc::Variable& variable() const { return *variable_; }
  /// Returns the time of the next tick [s]; kNever if none is scheduled.
  double next_s() const { return next_s_; }

  /// Queries the first tick. The instance must be in initialisation mode. Throws Error as update() does, and if the
  /// shift is negative or not a number.
  void start(ClockInstance& instance, double start_s);
  /// Marks the scheduled tick as done. The next tick is already known only for periodic clocks.
  void ticked();
  /// Queries intervals after an update of the discrete states at `time_s`. `has_ticked` is true if the clock ticked in
  /// this event. Throws Error if an interval is negative, not a number, or zero for a periodic clock.
  void update(ClockInstance& instance, double time_s, bool has_ticked);

  void visit(state::Visitor& v);

 private:
  bool is_periodic() const;
  double periodic_s(double count) const;
  /// Returns `time_s`. Throws Error if the time is negative or not finite, or if it is zero and `may_be_zero` is false.
  double checked(const ClockInstance& instance, std::string_view what, double time_s, bool may_be_zero) const;

  const modeldesc::Variable* variable_;
  double next_s_ = kNever;
  double interval_s_ = 0;
  // For a periodic clock, tick number n is at base + n * interval.
  bool is_declared_ = false;  // by counters in modelDescription.xml
  double base_s_ = 0;
  double count_ = 0;  // of the next tick
};

}  // namespace mebots::master
