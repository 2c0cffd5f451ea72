// SPDX-License-Identifier: Apache-2.0
#include "engine/step_control/forced_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ranges>

namespace mebots::master {
namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

}  // namespace

ForcedPoints::ForcedPoints(const ResolvedSystem& system, Ensemble& ensemble, const OverrideSchedule* overrides)
    : ensemble_(&ensemble),
      overrides_(overrides),
      grid_(system.description->grid()),
      stop_ns_(system.description->stop_time_ns),
      last_(grid_.point_at(stop_ns_)) {
  const auto add = [&](std::int64_t period) {
    if (period > 1 && std::ranges::find(periods_, period) == periods_.end()) periods_.push_back(period);
  };
  add(system.description->record.every_steps);
  for (const auto& instance : system.instances) add(instance.description->steps);
  const auto add_times = [&](const std::shared_ptr<const Signal>& signal) {
    if (signal == nullptr || std::ranges::find(rows_, &signal->times()) != rows_.end()) return;
    rows_.push_back(&signal->times());
  };
  for (const auto& [input, source] : system.inputs) add_times(source.signal);
  for (const auto& signal : system.scenario_signals) add_times(signal);
  for (const auto& group : system.clock_groups) with_clocks_.push_back(group.members.front());
}

/// Returns the index of the first point at or after `time_ns`. If the step is not a whole number of nanoseconds, also
/// accepts a point that is one nanosecond earlier, because times of points are rounded.
std::int64_t ForcedPoints::point_from(std::int64_t time_ns) const {
  const auto k = grid_.point_at(time_ns);
  return grid_.has_passed(time_ns, grid_.time_ns(k), 0) ? k : k + 1;
}

/// Calls action(time_ns) for every time at which an override changes. Skips overrides whose start time is not known
/// yet.
template <typename Action>
void ForcedPoints::for_each_event(Action action) const {
  if (overrides_ == nullptr) return;
  for (std::size_t i = overrides_->inputs(); i < overrides_->overrides().size(); ++i) {
    const auto begin_ns = overrides_->begin_of(i);
    if (!begin_ns) continue;
    const auto& description = *overrides_->overrides()[i].description;
    const auto left_ns = stop_ns_ - *begin_ns;
    action(*begin_ns);
    if (description.until_ns) action(*description.until_ns);
    if (description.duration_ns && *description.duration_ns < left_ns) action(*begin_ns + *description.duration_ns);
    if (description.over_ns > 0 && description.over_ns < left_ns) action(*begin_ns + description.over_ns);
  }
}

bool ForcedPoints::is_event(std::int64_t k) const {
  bool found = false;
  for_each_event([&](std::int64_t time_ns) { found |= point_from(time_ns) == k; });
  return found;
}

std::int64_t ForcedPoints::next_row_after(std::int64_t k) const {
  auto next = kNever;
  for (const auto* times : rows_) {
    const auto row = times->row_at(grid_.time_ns(k), SignalSide::after, 0);
    for (auto later = row == SignalTimes::kNone ? 0 : row + 1; later < times->size(); ++later) {
      const auto point = point_from(times->ns(later));
      if (point <= k) continue;  // the row's time belongs to a point that is already reached
      next = std::min(next, point);
      break;
    }
  }
  return next;
}

std::int64_t ForcedPoints::next_tick_after(std::int64_t k) const {
  auto next = kNever;
  for (const auto instance : with_clocks_) {
    const auto time_s = ensemble_->slave(instance).next_event_s();
    if (!time_s || *time_s >= grid_.time_s(stop_ns_)) continue;
    next = std::min(next, std::max(k + 1, point_from(std::llround(*time_s * 1e9))));
  }
  return next;
}

std::int64_t ForcedPoints::after(std::int64_t k) const {
  auto next = std::min({std::max(last_, k + 1), next_row_after(k), next_tick_after(k)});
  for (const auto period : periods_) next = std::min(next, (k / period + 1) * period);
  for_each_event([&](std::int64_t time_ns) {
    if (const auto point = point_from(time_ns); point > k) next = std::min(next, point);
  });
  return next;
}

}  // namespace mebots::master
