// SPDX-License-Identifier: Apache-2.0
#include "slave/clocked/clocked_slave.hpp"

#include "slave/clocked/clock_group.hpp"
#include "slave/member_state.hpp"

#include <utility>

namespace mebots::master {

ClockedSlave::ClockedSlave(std::unique_ptr<Slave> inner, std::size_t member, std::shared_ptr<ClockGroup> group)
    : ForwardingSlave(std::move(inner)), group_(std::move(group)), member_(member) {}

void ClockedSlave::setup_experiment(const Experiment& experiment) {
  inner().setup_experiment(experiment);
  group_->setup_experiment(experiment);
}

void ClockedSlave::exit_initialization() {
  group_->start_clocks(member_);
  inner().exit_initialization();
  group_->exit_initialization();
}

StepResult ClockedSlave::step(std::int64_t start_ns, std::int64_t duration_ns) {
  return group_->step(start_ns, duration_ns);
}

std::optional<double> ClockedSlave::next_event_s() const {
  const double next_s = group_->next_tick_s();
  return next_s == TimedClock::kNever ? std::nullopt : std::optional(next_s);
}

std::unique_ptr<SlaveState> ClockedSlave::save_state() {
  auto state = std::make_unique<MemberState>();
  state->inner = inner().save_state();
  if (member_ == 0) state->group = group_->save();
  return state;
}

void ClockedSlave::restore_state(const SlaveState& state) {
  const auto& saved = static_cast<const MemberState&>(state);
  inner().restore_state(*saved.inner);
  if (member_ == 0) group_->restore(saved.group);
}

std::vector<std::byte> ClockedSlave::serialize(const SlaveState& state) {
  return serialize_member(inner(), static_cast<const MemberState&>(state));
}

std::unique_ptr<SlaveState> ClockedSlave::deserialize(std::span<const std::byte> bytes) {
  return deserialize_member(inner(), bytes);
}

}  // namespace mebots::master
