// SPDX-License-Identifier: Apache-2.0
#include "base/time_grid.hpp"

#include "mebots/assert.hpp"

#include <numeric>

namespace mebots::master {

// denominator_ is at most 1e9 * 1e9, and |t| is at most 9.2e9 s. Numerators are below 1e28 for seconds and below 1e37
// for nanoseconds. 128 bits represent numbers up to 1.7e38.
TimeGrid::TimeGrid(std::int64_t start_ns, const ExactTime& step)
    : start_ns_(start_ns), step_ns_(to_nanoseconds(step)), is_whole_(step.is_whole_nanoseconds()) {
  MEBOTS_ASSERT(step.numerator > 0);
  MEBOTS_ASSERT(is_whole_ || step_ns_ >= kShortestRatioNs, "the reader refuses shorter ratios");
  const auto start = exact_time_of(start_ns);
  denominator_ = std::lcm(start.denominator, step.denominator);
  start_ = WideInteger{start.numerator} * (denominator_ / start.denominator);
  step_ = WideInteger{step.numerator} * (denominator_ / step.denominator);
}

std::int64_t TimeGrid::rounded_ns(std::int64_t k) const {
  return nearest_whole((start_ + k * step_) * kNanosecondsPerSecond, denominator_);
}

std::int64_t TimeGrid::nearest_point(std::int64_t time_ns) const {
  const auto passed_ns = WideInteger{time_ns} - start_ns_;
  return nearest_whole(passed_ns * denominator_, step_ * kNanosecondsPerSecond);
}

bool TimeGrid::is_point(std::int64_t time_ns) const {
  return time_ns >= start_ns_ && this->time_ns(nearest_point(time_ns)) == time_ns;
}

std::int64_t TimeGrid::point_at(std::int64_t time_ns) const {
  const auto k = nearest_point(time_ns);
  return this->time_ns(k) <= time_ns ? k : k - 1;
}

double TimeGrid::exact_s(std::int64_t time_ns) const {
  const auto k = nearest_point(time_ns);
  if (rounded_ns(k) != time_ns) return to_seconds(time_ns);
  return nearest_double(start_ + k * step_, denominator_);
}

double TimeGrid::exact_length_s(std::int64_t from_ns, std::int64_t to_ns) const {
  const auto from = nearest_point(from_ns);
  const auto to = nearest_point(to_ns);
  const bool from_point = rounded_ns(from) == from_ns;
  const bool to_point = rounded_ns(to) == to_ns;
  if (from_point && to_point) return nearest_double((to - from) * step_, denominator_);
  if (!from_point && !to_point) return to_seconds(to_ns - from_ns);
  return exact_s(to_ns) - exact_s(from_ns);
}

}  // namespace mebots::master
