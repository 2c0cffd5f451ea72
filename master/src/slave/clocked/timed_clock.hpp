// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "solver/clock_instance.hpp"

#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

namespace mebots::master {

/// Computes the ticks of a time-based input clock (FMI 3.0.2, section 2.2.8). The clock can be periodic, changing or a
/// countdown.
class TimedClock {
 public:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  /// `variable` must be a Clock and must outlive this object.
  explicit TimedClock(const modeldesc::Variable& variable) : variable_(&variable) {}

  const modeldesc::Variable& variable() const { return *variable_; }
  /// Returns the time of the next tick in seconds; kNever if no tick is scheduled.
  double next_s() const { return next_s_; }

  /// Queries the first tick. The instance must be in initialization mode. Throws Error if the shift is negative or not
  /// finite, and in the cases in which update() throws.
  void start(ClockInstance& instance, double start_s);
  /// Must be called after the scheduled tick. Schedules the next tick of a periodic clock.
  void ticked();
  /// Queries the interval after update_discrete_states() at `time_s`. `has_ticked` is true if the clock ticked during
  /// this event. Throws Error if an interval is negative or not finite, or if a periodic clock has the interval 0.
  void update(ClockInstance& instance, double time_s, bool has_ticked);

  void visit(state::Visitor& v);

 private:
  bool is_periodic() const;
  double periodic_s(double count) const;
  /// Returns `time_s`. Throws Error if it is negative or not finite, or if it is 0 and `may_be_zero` is false.
  double checked(const ClockInstance& instance, std::string_view what, double time_s, bool may_be_zero) const;

  const modeldesc::Variable* variable_;
  double next_s_ = kNever;
  double interval_s_ = 0;
  // Tick n of a periodic clock is at base_s_ + n * interval.
  bool is_declared_ = false;  // true if modelDescription.xml contains counters of the interval
  double base_s_ = 0;
  double count_ = 0;  // number of the next tick
};

}  // namespace mebots::master
