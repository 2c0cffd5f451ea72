// SPDX-License-Identifier: Apache-2.0
#include "tool/power_course.hpp"

#include <algorithm>
#include <utility>

namespace mebots::soc::tool {

void ClockRange::add(double hz, Picoseconds span) {
  if (hz == 0 || span <= 0) return;
  least_hz_ = has_run() ? std::min(least_hz_, hz) : hz;
  most_hz_ = std::max(most_hz_, hz);
  ticks_ += hz * static_cast<double>(span);
  span_ += static_cast<double>(span);
}

PowerCourse::PowerCourse(const Soc& soc) : soc_(soc) {
  for (const auto& slot : soc.devices()) {
    if (!slot.entry->states.empty()) devices_.push_back(slot.entry->name);
  }
  add(soc.now());
  add_clocks(soc.now());
}

void PowerCourse::changed(Picoseconds time) {
  add_clocks(time);
  if (time - points_.back().time >= spacing_) add(time);
}

/// Adds the clocks that were read at the last call, for the time since that call. Then reads the present clocks.
void PowerCourse::add_clocks(Picoseconds time) {
  controller_clock_.add(controller_hz_, time - clocks_since_);
  cluster_clock_.add(cluster_hz_, time - clocks_since_);
  clocks_since_ = time;
  controller_hz_ = soc_.power().clock_hz();
  const auto* cluster = soc_.cluster();
  cluster_hz_ = cluster != nullptr && cluster->powered() ? cluster->clock_hz() : 0;
}

void PowerCourse::finish() {
  add_clocks(soc_.now());
  if (soc_.now() > points_.back().time) add(soc_.now());
}

void PowerCourse::add(Picoseconds time) {
  Point point;
  point.time = time;
  for (const auto& component : soc_.power().energy_at(time).components()) point.parts_j.push_back(component.energy_j);
  for (const auto& slot : soc_.devices()) {
    if (!slot.entry->states.empty()) point.devices_j.push_back(slot.device->energy_j(time));
  }
  for (std::size_t i = 0; i < point.in_state.size(); ++i) point.in_state[i] = soc_.state_times().total(i);
  points_.push_back(std::move(point));
  if (points_.size() >= kMost) halve();
}

/// Deletes every second point, except the first and the last one.
void PowerCourse::halve() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const bool stays = i % 2 == 0 || i + 1 == points_.size();
    if (stays && i != kept) points_[kept] = std::move(points_[i]);
    if (stays) ++kept;
  }
  points_.resize(kept);
  spacing_ *= 2;
}

}  // namespace mebots::soc::tool
