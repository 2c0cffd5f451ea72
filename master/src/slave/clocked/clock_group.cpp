// SPDX-License-Identifier: Apache-2.0
#include "slave/clocked/clock_group.hpp"

#include "mebots/assert.hpp"
#include "mebots/state/save.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Type;

/// Ticks closer together than this are simultaneous: the resolution of the master's clock.
constexpr double kSameTime_s = 0.5e-9;
/// Limits the instants of one event, and the steps without progress. Beyond this number, the clocks are reported as
/// never settling.
constexpr int kMostInstants = 1000;
/// Limits the sweeps over all connections at one instant. Beyond this number, the values are reported as never
/// settling.
constexpr int kMostClockSweeps = 200;

bool any_of(const std::vector<ValueReference>& clocks, const std::set<ValueReference>& ticking) {
  return std::ranges::any_of(clocks, [&](auto clock) { return ticking.contains(clock); });
}

StepResult not_done(bool terminated, double time_s) {
  StepResult result;
  result.done = false;
  result.terminated = terminated;
  result.last_successful_s = time_s;
  return result;
}

}  // namespace

std::size_t ClockGroup::add(ClockedSlave& slave) {
  Member member;
  member.slave = &slave;
  for (const auto& variable : slave.description().variables) {
    if (variable.type != Type::clock) continue;
    if (variable.causality == Causality::output) member.outputs.push_back(variable.value_reference);
    if (variable.causality == Causality::input && variable.fmi3->timing->is_time_based()) {
      member.timed.emplace_back(variable);
    }
  }
  steps_vary_ &= slave.description().co_simulation->can_handle_variable_communication_step_size;
  members_.push_back(std::move(member));
  return members_.size() - 1;
}

void ClockGroup::connect(std::vector<ClockLink> clocks, std::vector<ClockedLink> values) {
  clock_links_ = std::move(clocks);
  value_links_ = std::move(values);
  sent_.resize(value_links_.size());
}

void ClockGroup::start_clocks(std::size_t member) {
  auto& starting = members_[member];
  starting.time_s = grid_.time_s(start_ns_);
  for (auto& clock : starting.timed) clock.start(starting.instance(), starting.time_s);
}

/// After initialisation, members are in event mode.
void ClockGroup::exit_initialization() {
  if (++initialised_ < members_.size()) return;
  for (auto& member : members_) member.in_event = true;
  ended_ = !handle_events(grid_.time_s(start_ns_));
}

StepResult ClockGroup::step(std::int64_t start_ns, std::int64_t duration_ns) {
  if (given_to_ == 0) result_ = advance(grid_.time_s(start_ns + duration_ns));
  if (++given_to_ == members_.size()) given_to_ = 0;
  return result_;
}

double ClockGroup::next_tick_s() const {
  double next_s = TimedClock::kNever;
  for (const auto& member : members_) {
    for (const auto& clock : member.timed) next_s = std::min(next_s, clock.next_s());
  }
  return next_s;
}

bool ClockGroup::is_anything_due(double time_s) const {
  return next_tick_s() <= time_s + kSameTime_s || std::ranges::any_of(members_, &Member::needs_event);
}

StepResult ClockGroup::advance(double end_s) {
  if (ended_) return not_done(true, members_.front().time_s);
  int idle = 0;
  while (true) {
    const double before_s = std::ranges::min_element(members_, {}, &Member::time_s)->time_s;
    double target_s = steps_vary_ ? std::min(end_s, next_tick_s()) : end_s;
    if (end_s - target_s <= kSameTime_s) target_s = end_s;
    auto result = step_members(target_s);
    if (!result.done) return result;
    if (is_anything_due(target_s) && !handle_events(target_s)) return not_done(true, target_s);
    const double reached_s = std::ranges::min_element(members_, {}, &Member::time_s)->time_s;
    if (reached_s >= end_s && !is_anything_due(end_s)) return result;
    idle = reached_s > before_s ? 0 : idle + 1;
    if (idle == kMostInstants) fail_to_rest(reached_s);
  }
}

/// Steps all members to `target_s`, or to the time at which the first of them returns early.
StepResult ClockGroup::step_members(double& target_s) {
  for (auto& member : members_) {
    if (member.time_s >= target_s) continue;
    const auto end = member.instance().step_until(member.time_s, target_s);
    if (!end) return not_done(false, member.time_s);
    if (end->terminate) return not_done(true, end->time_s);
    member.time_s = end->time_s;
    member.needs_event = end->event;
    target_s = std::min(target_s, end->time_s);
  }
  return {};
}

void ClockGroup::enter(Member& member, double time_s) {
  if (member.in_event) return;
  member.instance().enter_event_mode();
  member.in_event = true;
  if (member.time_s <= time_s + kSameTime_s) return;
  notice(member, time_s,
         "is too late: the instance has already stepped past it. List the instance that has such events earlier "
         "in the config, or take shorter steps");
}

/// Sends a notice, once per run.
void ClockGroup::notice(const Member& member, double time_s, const std::string& text) {
  if (std::exchange(noticed_, true)) return;
  messages_->message({member.slave->name(), Severity::warning, "notice",
                      fmt::format("an event of its clocks at {:.9g} s {}", time_s, text),
                      std::llround(member.time_s * 1e9)});
}

/// Activates a clock. Returns false if it already ticks at this instant.
bool ClockGroup::tick(Member& member, ValueReference clock, double time_s) {
  if (member.ticking.contains(clock)) return false;
  enter(member, time_s);
  member.instance().tick(clock);
  member.ticking.insert(clock);
  member.slave->give_inputs(clock);
  return true;
}

void ClockGroup::tick_timed_clocks(double time_s) {
  for (auto& member : members_) {
    for (auto& clock : member.timed) {
      if (clock.next_s() > time_s + kSameTime_s) continue;
      if (clock.next_s() < time_s - kSameTime_s) {
        notice(member, clock.next_s(),
               "waits for a communication point, because an instance cannot step to any time "
               "(canHandleVariableCommunicationStepSize = false). Take shorter steps");
      }
      tick(member, clock.variable().value_reference, time_s);
      clock.ticked();
    }
  }
}

/// Propagates ticks along the connections. Returns true if a further clock starts to tick.
bool ClockGroup::propagate_ticks(double time_s) {
  bool changed = false;
  for (auto& member : members_) {
    if (!member.in_event) continue;
    for (const auto clock : member.outputs) {
      if (!member.ticking.contains(clock) && member.instance().ticks(clock)) {
        changed |= member.ticking.insert(clock).second;
      }
    }
  }
  for (const auto& link : clock_links_) {
    if (members_[link.from].ticking.contains(link.from_clock)) {
      changed |= tick(members_[link.to], link.to_clock, time_s);
    }
  }
  return changed;
}

/// Propagates values along the connections. Returns true if an input changes.
bool ClockGroup::propagate_values() {
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

/// Propagates ticks and values of one instant until nothing changes.
void ClockGroup::propagate(double time_s) {
  for (auto& sent : sent_) sent.reset();
  for (int sweep = 0; sweep < kMostClockSweeps; ++sweep) {
    const bool ticked = propagate_ticks(time_s);
    if (!propagate_values() && !ticked) return;
  }
  throw SlaveError(fmt::format("instance '{}': the values of its clocks still change after {} sweeps at {:.9g} s",
                               members_.front().slave->name(), kMostClockSweeps, time_s));
}

void ClockGroup::fail_to_rest(double time_s) const {
  throw SlaveError(fmt::format("instance '{}': the clocks of its group tick at {:.9g} s without end",
                               members_.front().slave->name(), time_s));
}

/// Ends the instant. Returns true if a member requests another update of discrete states.
bool ClockGroup::update_members(double time_s, bool& terminated) {
  bool needs_another = false;
  for (auto& member : members_) {
    if (!member.in_event) continue;
    for (const auto clock : member.ticking) member.slave->store_outputs(clock);
    const auto update = member.instance().update_discrete_states();
    needs_another |= update.needs_another;
    terminated |= update.terminate;
    for (auto& clock : member.timed) {
      clock.update(member.instance(), time_s, member.ticking.contains(clock.variable().value_reference));
    }
    member.ticking.clear();
  }
  return needs_another;
}

/// Handles events at the present time. Returns false if a member ends the simulation. Otherwise leaves all members in
/// step mode.
bool ClockGroup::handle_events(double time_s) {
  for (auto& member : members_) {
    if (!std::exchange(member.needs_event, false)) continue;
    enter(member, time_s);
  }
  bool terminated = false;
  for (int instant = 0;; ++instant) {
    if (instant == kMostInstants) fail_to_rest(time_s);
    tick_timed_clocks(time_s);
    propagate(time_s);
    const bool needs_another = update_members(time_s, terminated);
    if (terminated) return false;
    if (!needs_another && !is_anything_due(time_s)) break;
  }
  for (auto& member : members_) {
    if (std::exchange(member.in_event, false)) member.instance().enter_step_mode();
  }
  return true;
}

void ClockGroup::Member::visit(state::Visitor& v) {
  v("time_s", time_s);
  for (auto& clock : timed) v(clock.variable().name, clock);
}

void ClockGroup::visit(state::Visitor& v) {
  for (auto& member : members_) v(member.slave->name(), member);
}

std::vector<std::byte> ClockGroup::save() const {
  return state::save(*this);
}

void ClockGroup::restore(std::span<const std::byte> bytes) {
  state::restore(*this, bytes);
  given_to_ = 0;
}

}  // namespace mebots::master
