// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/time.hpp"

#include <cstdint>

namespace mebots::master {

/// The communication points of a run: t_k = t_0 + k p / q, where p / q is the step. t_0 is a whole number of
/// nanoseconds. The points are computed exactly, not as a running sum. The internal time of a point is t_k rounded to
/// nanoseconds, ties to even. Different points have different internal times. FMUs receive the doubles nearest to t_k
/// and to the step.
class TimeGrid {
 public:
  /// The minimum step in nanoseconds if the step is not a whole number of nanoseconds.
  static constexpr std::int64_t kShortestRatioNs = 10;

  /// Creates a grid with the start time 0 and a step of one nanosecond.
  TimeGrid() = default;
  /// The step must be positive. If it is not a whole number of nanoseconds, it must be at least kShortestRatioNs.
  TimeGrid(std::int64_t start_ns, const ExactTime& step);

  /// Returns the internal time of point k.
  std::int64_t time_ns(std::int64_t k) const { return is_whole_ ? start_ns_ + k * step_ns_ : rounded_ns(k); }
  /// True if `time_ns` is the internal time of a communication point. Points before the start time do not count.
  bool is_point(std::int64_t time_ns) const;
  /// Returns the index k of the last communication point that is not after `time_ns`.
  std::int64_t point_at(std::int64_t time_ns) const;

  /// Returns the time in seconds for an FMU: the double nearest to t_k if `time_ns` is the internal time of a point,
  /// otherwise the double nearest to `time_ns`.
  double time_s(std::int64_t time_ns) const { return is_whole_ ? to_seconds(time_ns) : exact_s(time_ns); }
  /// Returns the double nearest to the duration in seconds. Exception: if the step is not a whole number of
  /// nanoseconds, and only one of the two times is a communication point, returns time_s(to_ns) - time_s(from_ns).
  double length_s(std::int64_t from_ns, std::int64_t to_ns) const {
    return is_whole_ ? to_seconds(to_ns - from_ns) : exact_length_s(from_ns, to_ns);
  }
  /// True if at least `duration_ns` have passed. Tolerates one nanosecond less if the step is not a whole number of
  /// nanoseconds, because internal times are rounded.
  bool has_passed(std::int64_t from_ns, std::int64_t to_ns, std::int64_t duration_ns) const {
    return to_ns - from_ns >= duration_ns - (is_whole_ ? 0 : 1);
  }

 private:
  std::int64_t rounded_ns(std::int64_t k) const;
  double exact_s(std::int64_t time_ns) const;
  double exact_length_s(std::int64_t from_ns, std::int64_t to_ns) const;
  std::int64_t nearest_point(std::int64_t time_ns) const;

  std::int64_t start_ns_ = 0;
  std::int64_t step_ns_ = 1;  // rounded to nanoseconds
  bool is_whole_ = true;
  // t_k = (start_ + k step_) / denominator_ seconds.
  WideInteger start_ = 0;
  WideInteger step_ = 1;
  std::int64_t denominator_ = kNanosecondsPerSecond;
};

}  // namespace mebots::master
