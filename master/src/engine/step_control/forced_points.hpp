// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"
#include "model/override_schedule.hpp"
#include "model/resolved_system.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mebots::master {

/// Finds the points of the grid that no communication step may pass: the end of the run, ends of longer steps,
/// recording times, starts and ends of overrides, rows of signals, and ticks of clocks. Checkpoints and pauses do not
/// force a point, because they must not change the results.
class ForcedPoints {
 public:
  /// All arguments must outlive this object; `overrides` may be null.
  ForcedPoints(const ResolvedSystem& system, Ensemble& ensemble, const OverrideSchedule* overrides);

  /// Returns the index of the first forced point after t_k.
  std::int64_t after(std::int64_t k) const;
  /// True if an override starts, ends or changes its values at t_k, so that variables may jump.
  bool is_event(std::int64_t k) const;

 private:
  std::int64_t point_from(std::int64_t time_ns) const;
  template <typename Action>
  void for_each_event(Action action) const;
  std::int64_t next_row_after(std::int64_t k) const;
  std::int64_t next_tick_after(std::int64_t k) const;

  Ensemble* ensemble_;
  const OverrideSchedule* overrides_;
  TimeGrid grid_;
  std::int64_t stop_ns_;
  std::int64_t last_;                     // index of the last point of the run
  std::vector<const SignalTimes*> rows_;  // times of the rows of all signals
  std::vector<std::int64_t> periods_;     // recording interval and step lengths, in intervals of the grid
  std::vector<std::size_t> with_clocks_;  // one instance of each clock group
};

}  // namespace mebots::master
