// SPDX-License-Identifier: Apache-2.0
#include "slave/clocked/timed_clock.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>

#include <cmath>

namespace mebots::master {

using modeldesc::IntervalVariability;

bool TimedClock::is_periodic() const {
  const auto variability = variable_->fmi3->timing->interval_variability;
  return variability == IntervalVariability::constant || variability == IntervalVariability::fixed ||
         variability == IntervalVariability::tunable;
}

/// Multiplies the interval by the count instead of adding intervals, so that rounding errors do not accumulate.
double TimedClock::periodic_s(double count) const {
  const auto& timing = *variable_->fmi3->timing;
  if (!is_declared_) return base_s_ + count * interval_s_;
  const auto ticks =
      static_cast<double>(timing.shift_counter.value_or(0)) + count * static_cast<double>(*timing.interval_counter);
  return base_s_ + ticks / static_cast<double>(*timing.resolution);
}

double TimedClock::checked(const EventInstance& instance, double interval_s) const {
  if (std::isfinite(interval_s) && (interval_s > 0 || (interval_s == 0 && !is_periodic()))) return interval_s;
  throw Error(ErrorCode::fmu_failed,
              fmt::format("instance '{}': the clock '{}' has the interval {} s; it must be a time {} 0",
                          instance.name(), variable_->name, interval_s, is_periodic() ? "above" : "of at least"));
}

double TimedClock::checked_shift(const EventInstance& instance, double shift_s) const {
  if (std::isfinite(shift_s) && shift_s >= 0) return shift_s;
  throw Error(ErrorCode::fmu_failed,
              fmt::format("instance '{}': the clock '{}' has the shift {} s; it must be a time of at least 0",
                          instance.name(), variable_->name, shift_s));
}

void TimedClock::start(EventInstance& instance, double start_s) {
  const auto& timing = *variable_->fmi3->timing;
  base_s_ = start_s;
  count_ = 0;
  if (!is_periodic()) {
    const auto interval_s = instance.new_interval(variable_->value_reference);
    if (interval_s) interval_s_ = checked(instance, *interval_s);
    next_s_ = interval_s ? start_s + interval_s_ : kNever;
    return;
  }
  is_declared_ = timing.interval_counter && timing.resolution && *timing.interval_counter > 0;
  if (!is_declared_ && timing.interval_s) {
    interval_s_ = checked(instance, *timing.interval_s);
    base_s_ += checked_shift(instance, timing.shift_s);
  } else if (!is_declared_) {
    const auto interval_s = instance.new_interval(variable_->value_reference);
    interval_s_ = checked(instance, interval_s.value_or(0));
    base_s_ += checked_shift(instance, instance.shift(variable_->value_reference));
  }
  next_s_ = periodic_s(count_);
}

void TimedClock::ticked() {
  next_s_ = is_periodic() ? periodic_s(++count_) : kNever;
}

void TimedClock::update(EventInstance& instance, double time_s, bool has_ticked) {
  const auto& timing = *variable_->fmi3->timing;
  const auto variability = timing.interval_variability;
  const bool asks = variability == IntervalVariability::countdown ||
                    (variability == IntervalVariability::changing && has_ticked) ||
                    (variability == IntervalVariability::tunable && !timing.interval_s && !timing.interval_counter);
  if (!asks) return;
  const auto interval_s = instance.new_interval(variable_->value_reference);
  if (!is_periodic()) {
    if (interval_s) interval_s_ = checked(instance, *interval_s);
    // If a changing clock has ticked and reports no new interval, the previous one applies.
    if (interval_s || variability == IntervalVariability::changing) next_s_ = time_s + interval_s_;
    return;
  }
  if (!interval_s || *interval_s == interval_s_) return;
  interval_s_ = checked(instance, *interval_s);
  base_s_ = time_s;
  count_ = 1;
  next_s_ = periodic_s(count_);
}

void TimedClock::visit(state::Visitor& v) {
  v("next_s", next_s_);
  v("is_declared", is_declared_);
  v("base_s", base_s_);
  v("interval_s", interval_s_);
  v("count", count_);
}

}  // namespace mebots::master
