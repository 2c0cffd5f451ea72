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

/// Returns the time of tick `count`. Multiplies the interval instead of adding intervals, so that rounding errors do
/// not accumulate.
double TimedClock::periodic_s(double count) const {
  const auto& timing = *variable_->fmi3->timing;
  if (!is_declared_) return base_s_ + count * interval_s_;
  const auto ticks =
      static_cast<double>(timing.shift_counter.value_or(0)) + count * static_cast<double>(*timing.interval_counter);
  return base_s_ + ticks / static_cast<double>(*timing.resolution);
}

double TimedClock::checked(const ClockInstance& instance, std::string_view what, double time_s,
                           bool may_be_zero) const {
  if (std::isfinite(time_s) && (time_s > 0 || (time_s == 0 && may_be_zero))) return time_s;
  throw Error(ErrorCode::fmu_failed,
              fmt::format("instance '{}': the clock '{}' has the {} {} s; it must be a time {} 0", instance.name(),
                          variable_->name, what, time_s, may_be_zero ? "of at least" : "above"));
}

void TimedClock::start(ClockInstance& instance, double start_s) {
  const auto& timing = *variable_->fmi3->timing;
  base_s_ = start_s;
  count_ = 0;
  if (!is_periodic()) {
    const auto interval_s = instance.new_interval(variable_->value_reference);
    if (interval_s) interval_s_ = checked(instance, "interval", *interval_s, true);
    next_s_ = interval_s ? start_s + interval_s_ : kNever;
    return;
  }
  is_declared_ = timing.interval_counter && timing.resolution && *timing.interval_counter > 0;
  if (!is_declared_ && timing.interval_s) {
    interval_s_ = checked(instance, "interval", *timing.interval_s, false);
    base_s_ += checked(instance, "shift", timing.shift_s, true);
  } else if (!is_declared_) {
    const auto interval_s = instance.new_interval(variable_->value_reference);
    interval_s_ = checked(instance, "interval", interval_s.value_or(0), false);
    base_s_ += checked(instance, "shift", instance.shift(variable_->value_reference), true);
  }
  next_s_ = periodic_s(count_);
}

void TimedClock::ticked() {
  next_s_ = is_periodic() ? periodic_s(++count_) : kNever;
}

void TimedClock::update(ClockInstance& instance, double time_s, bool has_ticked) {
  const auto& timing = *variable_->fmi3->timing;
  const auto variability = timing.interval_variability;
  const bool asks = variability == IntervalVariability::countdown ||
                    (variability == IntervalVariability::changing && has_ticked) ||
                    (variability == IntervalVariability::tunable && !timing.interval_s && !timing.interval_counter);
  if (!asks) return;
  const auto interval_s = instance.new_interval(variable_->value_reference);
  if (!is_periodic()) {
    if (interval_s) interval_s_ = checked(instance, "interval", *interval_s, true);
    // A changing clock that reports no new interval keeps its interval.
    if (interval_s || variability == IntervalVariability::changing) next_s_ = time_s + interval_s_;
    return;
  }
  if (!interval_s || *interval_s == interval_s_) return;
  interval_s_ = checked(instance, "interval", *interval_s, false);
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
