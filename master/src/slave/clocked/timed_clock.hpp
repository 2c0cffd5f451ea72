// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "slave/clocked/event_instance.hpp"

#include <cstdint>
#include <limits>
#include <optional>

namespace mebots::master {

/// The ticks of an input clock that has a timing of its own: periodic, changing or countdown (FMI 3.0.2, section
/// 2.2.8).
class TimedClock {
 public:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  /// `variable` is of type Clock, and must outlive this object.
  explicit TimedClock(const modeldesc::Variable& variable) : variable_(&variable) {}

  const modeldesc::Variable& variable() const { return *variable_; }
  /// The next tick [s]; kNever if there is none in sight.
  double next_s() const { return next_s_; }

  /// Asks for the first tick. In initialisation mode.
  void start(EventInstance& instance, double start_s);
  /// The clock ticks at its time: what follows is known for periodic clocks only.
  void ticked();
  /// After an update of the discrete states at `time_s`. `has_ticked`: in this event. Throws Error for an interval that
  /// is negative, not a number, or zero for a periodic clock.
  void update(EventInstance& instance, double time_s, bool has_ticked);

  void visit(state::Visitor& v);

 private:
  bool is_periodic() const;
  double periodic_s(double count) const;
  double checked(const EventInstance& instance, double interval_s) const;

  const modeldesc::Variable* variable_;
  double next_s_ = kNever;
  double interval_s_ = 0;
  // Of a periodic clock: tick number n is at base + n * interval.
  bool is_declared_ = false;  // by counters of modelDescription.xml
  double base_s_ = 0;
  double count_ = 0;  // of the next tick
};

}  // namespace mebots::master
