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

/// The maximum number of discrete updates in one event, and of consecutive steps without progress in time. A group that
/// exceeds it fails, because its clocks never settle.
constexpr int kMostInstants = 1000;

StepResult not_done(bool terminated, double time_s) {
  StepResult result;
  result.done = false;
  result.terminated = terminated;
  result.last_successful_s = time_s;
  return result;
}

}  // namespace

std::size_t ClockGroup::add(HoldingSlave& slave, EventInstance& instance) {
  network_.add(members_.size(), slave, instance.clocks());
  steps_vary_ &= slave.description().co_simulation->can_handle_variable_communication_step_size;
  members_.push_back({.instance = &instance});
  return members_.size() - 1;
}

void ClockGroup::start_clocks(std::size_t member) {
  members_[member].time_s = grid_.time_s(start_ns_);
  network_.start(member, members_[member].time_s);
}

/// Handles the events at the start. The members are in event mode after initialization.
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

bool ClockGroup::is_anything_due(double time_s) const {
  return network_.is_due(time_s) || std::ranges::any_of(members_, &Member::needs_event);
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

/// Steps all members to `target_s`. If a member returns early, reduces `target_s` to this time.
StepResult ClockGroup::step_members(double& target_s) {
  for (auto& member : members_) {
    if (member.time_s >= target_s) continue;
    const auto end = member.instance->step_until(member.time_s, target_s);
    if (!end) return not_done(false, member.time_s);
    if (end->terminate) return not_done(true, end->time_s);
    member.time_s = end->time_s;
    member.needs_event = end->event;
    target_s = std::min(target_s, end->time_s);
  }
  return {};
}

void ClockGroup::enter_event(std::size_t index, double time_s) {
  auto& member = members_[index];
  if (member.in_event) return;
  member.instance->enter_event_mode();
  member.in_event = true;
  if (member.time_s <= time_s + kSameTime_s) return;
  notice(member, time_s,
         "is too late: the instance has already stepped past it. List the instance that has such events earlier "
         "in the config, or take shorter steps");
}

void ClockGroup::note_late_tick(std::size_t member, double tick_s) {
  notice(members_[member], tick_s,
         "waits for a communication point, because an instance cannot step to any time "
         "(canHandleVariableCommunicationStepSize = false). Take shorter steps");
}

void ClockGroup::notice(const Member& member, double time_s, const std::string& text) {
  if (std::exchange(noticed_, true)) return;
  messages_->message({member.instance->name(), Severity::warning, "notice",
                      fmt::format("an event of its clocks at {:.9g} s {}", time_s, text),
                      std::llround(member.time_s * 1e9)});
}

void ClockGroup::fail_to_rest(double time_s) const {
  throw SlaveError(fmt::format("instance '{}': the clocks of its group tick at {:.9g} s without end",
                               members_.front().instance->name(), time_s));
}

/// Updates the discrete states of all members. Returns true if a member requests another update.
bool ClockGroup::update_members(double time_s, bool& terminated) {
  bool needs_another = false;
  for (std::size_t m = 0; m < members_.size(); ++m) {
    if (!members_[m].in_event) continue;
    network_.before_update(m);
    const auto update = members_[m].instance->update_discrete_states();
    needs_another |= update.needs_another;
    terminated |= update.terminate;
    network_.after_update(m, time_s);
  }
  return needs_another;
}

/// Handles the events at `time_s`. Returns false if a member ends the simulation. Otherwise, all members are then in
/// step mode.
bool ClockGroup::handle_events(double time_s) {
  for (std::size_t m = 0; m < members_.size(); ++m) {
    if (std::exchange(members_[m].needs_event, false)) enter_event(m, time_s);
  }
  bool terminated = false;
  for (int instant = 0;; ++instant) {
    if (instant == kMostInstants) fail_to_rest(time_s);
    network_.begin_instant(time_s);
    network_.propagate(time_s);
    const bool needs_another = update_members(time_s, terminated);
    if (terminated) return false;
    if (!needs_another && !is_anything_due(time_s)) break;
  }
  for (auto& member : members_) {
    if (std::exchange(member.in_event, false)) member.instance->enter_step_mode();
  }
  return true;
}

void ClockGroup::visit(state::Visitor& v) {
  for (auto& member : members_) v(member.instance->name(), member.time_s);
  v("clocks", network_);
}

std::vector<std::byte> ClockGroup::save() const {
  return state::save(*this);
}

void ClockGroup::restore(std::span<const std::byte> bytes) {
  state::restore(*this, bytes);
  given_to_ = 0;
}

}  // namespace mebots::master
