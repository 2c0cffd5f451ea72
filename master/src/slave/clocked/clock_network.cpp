// SPDX-License-Identifier: Apache-2.0
#include "slave/clocked/clock_network.hpp"

#include "mebots/assert.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Type;

/// The maximum number of sweeps over all connections at one time. A network that exceeds it fails, because its values
/// do not converge.
constexpr int kMostClockSweeps = 200;

bool any_of(const std::vector<ValueReference>& clocks, const std::set<ValueReference>& ticking) {
  return std::ranges::any_of(clocks, [&](auto clock) { return ticking.contains(clock); });
}

}  // namespace

void ClockNetwork::add(std::size_t member, HoldingSlave& slave, ClockInstance& clocks) {
  members_.resize(std::max(members_.size(), member + 1));
  auto& added = members_[member];
  added.slave = &slave;
  added.clocks = &clocks;
  for (const auto& variable : slave.description().variables) {
    if (variable.type != Type::clock) continue;
    if (variable.causality == Causality::output) added.outputs.push_back(variable.value_reference);
    if (variable.causality == Causality::input && variable.fmi3->timing->is_time_based()) {
      added.timed.emplace_back(variable);
    }
  }
}

void ClockNetwork::connect(std::vector<ClockLink> clocks, std::vector<ClockedLink> values) {
  clock_links_ = std::move(clocks);
  value_links_ = std::move(values);
  sent_.resize(value_links_.size());
}

void ClockNetwork::start(std::size_t member, double start_s) {
  if (member >= members_.size()) return;
  for (auto& clock : members_[member].timed) clock.start(*members_[member].clocks, start_s);
}

SystemClocks::Tick ClockNetwork::next_tick() const {
  Tick next;
  for (std::size_t m = 0; m < members_.size(); ++m) {
    for (const auto& clock : members_[m].timed) {
      if (clock.next_s() < next.time_s) next = {clock.next_s(), m};
    }
  }
  return next;
}

/// Makes a clock tick. Returns false if the clock already ticks at the current time.
bool ClockNetwork::tick(std::size_t member, ValueReference clock, double time_s) {
  auto& ticking = members_[member];
  if (ticking.ticking.contains(clock)) return false;
  modes_->enter_event(member, time_s);
  ticking.clocks->tick(clock);
  ticking.ticking.insert(clock);
  ticking.slave->give_inputs(clock);
  return true;
}

bool ClockNetwork::begin_instant(double time_s) {
  bool ticked = false;
  for (auto& sent : sent_) sent.reset();
  for (std::size_t m = 0; m < members_.size(); ++m) {
    for (auto& clock : members_[m].timed) {
      if (clock.next_s() > time_s + kSameTime_s) continue;
      if (clock.next_s() < time_s - kSameTime_s) modes_->note_late_tick(m, clock.next_s());
      ticked |= tick(m, clock.variable().value_reference, time_s);
      clock.ticked();
    }
  }
  return ticked;
}

/// Transfers ticks along the connections. Returns true if another clock ticks.
bool ClockNetwork::propagate_ticks(double time_s) {
  bool changed = false;
  for (std::size_t m = 0; m < members_.size(); ++m) {
    if (!modes_->is_in_event(m)) continue;
    auto& member = members_[m];
    for (const auto clock : member.outputs) {
      if (!member.ticking.contains(clock) && member.clocks->ticks(clock)) {
        changed |= member.ticking.insert(clock).second;
      }
    }
  }
  for (const auto& link : clock_links_) {
    if (members_[link.from].ticking.contains(link.from_clock)) changed |= tick(link.to, link.to_clock, time_s);
  }
  return changed;
}

/// Transfers values along the connections. Returns true if an input has changed.
bool ClockNetwork::propagate_values() {
  bool changed = false;
  for (std::size_t i = 0; i < value_links_.size(); ++i) {
    const auto& [link, from_clocks, to_clocks] = value_links_[i];
    auto& from = members_[link.from];
    auto& to = members_[link.to];
    if (!any_of(from_clocks, from.ticking) || !any_of(to_clocks, to.ticking)) continue;
    auto value = link.read(from.slave->alone());
    if (sent_[i] && is_same(*sent_[i], value)) continue;
    set_value(to.slave->alone(), link.to_kind, link.to_reference, value);
    sent_[i] = std::move(value);
    changed = true;
  }
  return changed;
}

bool ClockNetwork::propagate(double time_s) {
  bool changed = false;
  // Only sweeps that change values count towards the limit. The number of other sweeps is finite, because a clock ticks
  // at most once at each time instant.
  for (int sweeps = 0; sweeps < kMostClockSweeps;) {
    const bool ticked = propagate_ticks(time_s);
    const bool passed = propagate_values();
    if (!passed && !ticked) return changed;
    changed = true;
    if (passed) ++sweeps;
  }
  MEBOTS_ASSERT(!value_links_.empty());
  const auto& member = members_[value_links_.front().link.from];
  throw SlaveError(
      fmt::format("instance '{}': the clocked values of its group still change after {} sweeps at {:.9g} s; "
                  "remove a connection from the loop of clocked variables",
                  member.slave->name(), kMostClockSweeps, time_s));
}

void ClockNetwork::before_update(std::size_t member) {
  if (member >= members_.size()) return;
  for (const auto clock : members_[member].ticking) members_[member].slave->store_outputs(clock);
}

void ClockNetwork::after_update(std::size_t member, double time_s) {
  if (member >= members_.size()) return;
  auto& updated = members_[member];
  for (auto& clock : updated.timed) {
    clock.update(*updated.clocks, time_s, updated.ticking.contains(clock.variable().value_reference));
  }
  updated.ticking.clear();
}

void ClockNetwork::visit(state::Visitor& v) {
  for (auto& member : members_) {
    for (auto& clock : member.timed) v(member.slave->name() + "." + clock.variable().name, clock);
  }
}

}  // namespace mebots::master
