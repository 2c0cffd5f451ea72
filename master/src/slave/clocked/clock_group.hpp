// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/time_grid.hpp"
#include "message/message_hub.hpp"
#include "slave/clocked/clocked_slave.hpp"
#include "slave/clocked/timed_clock.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace mebots::master {

/// A connection of clocks: whenever the first clock ticks, the second clock ticks at the same instant.
struct ClockLink {
  std::size_t from = 0;  ///< member
  std::size_t to = 0;
  ValueReference from_clock = 0;
  ValueReference to_clock = 0;
};

/// A connection of clocked variables. A value is transferred at instants at which the clocks of both ends tick.
struct ClockedLink {
  DiscreteLink link;
  std::vector<ValueReference> from_clocks;
  std::vector<ValueReference> to_clocks;
};

/// The co-simulation slaves whose clocks are connected, or a single one with clocks. Steps them from tick to tick and
/// handles their events (FMI 3.0.2, sections 2.2.8 and 4.2.1). When the first member steps, the whole group advances.
///
/// Members step one after the other. If a member returns early to handle an event, later members step only to the time
/// of this event. Earlier members are then ahead, and handle the event at their own time. If a member cannot step to
/// any time (canHandleVariableCommunicationStepSize = false), clocks tick at communication points only.
class ClockGroup {
 public:
  /// Both arguments must outlive the group.
  ClockGroup(const TimeGrid& grid, MessageSink& messages) : grid_(grid), messages_(&messages) {}

  /// Adds a slave, which must outlive the group's last call. Returns its index among the members.
  std::size_t add(ClockedSlave& slave);
  /// Must be called before the first member leaves initialisation mode.
  void connect(std::vector<ClockLink> clocks, std::vector<ClockedLink> values);

  void setup_experiment(const Experiment& experiment) { start_ns_ = experiment.start_ns; }
  /// Queries the first ticks of a member's clocks. The member must be in initialisation mode.
  void start_clocks(std::size_t member);
  /// Handles the events at the start, after the last member has left initialisation mode.
  void exit_initialization();
  StepResult step(std::int64_t start_ns, std::int64_t duration_ns);
  /// Returns the next tick of any clock [s]; TimedClock::kNever if none is scheduled.
  double next_tick_s() const;

  /// Returns the times of members and clocks; the first member stores them.
  std::vector<std::byte> save() const;
  void restore(std::span<const std::byte> bytes);
  void visit(state::Visitor& v);

 private:
  struct Member {
    ClockedSlave* slave = nullptr;
    std::vector<TimedClock> timed;
    std::vector<ValueReference> outputs;  // clocks
    double time_s = 0;
    bool needs_event = false;
    bool in_event = false;
    std::set<ValueReference> ticking;  // clocks that tick at this instant
    std::set<ValueReference> ticked;   // clocks that have ticked since the member entered event mode

    EventInstance& instance() const { return slave->instance(); }
    void visit(state::Visitor& v);
  };

  StepResult advance(double end_s);
  StepResult step_members(double& target_s);
  bool is_anything_due(double time_s) const;
  bool handle_events(double time_s);
  void enter(Member& member, double time_s);
  void notice(const Member& member, double time_s, const std::string& text);
  bool tick(Member& member, ValueReference clock, double time_s);
  void tick_timed_clocks(double time_s);
  void propagate(double time_s);
  bool propagate_ticks(double time_s);
  bool propagate_values();
  [[noreturn]] void fail_to_rest(double time_s) const;
  bool update_members(double time_s, bool& terminated);

  TimeGrid grid_;
  MessageSink* messages_;
  std::vector<Member> members_;
  std::vector<ClockLink> clock_links_;
  std::vector<ClockedLink> value_links_;
  std::vector<std::optional<LinkValue>> sent_;  // by value link, at this instant
  std::int64_t start_ns_ = 0;
  std::size_t initialised_ = 0;
  bool ended_ = false;        // a member ended the simulation at its start
  StepResult result_;         // of the step, the same for all members
  std::size_t given_to_ = 0;  // number of members that received the result; 0: the next call advances the group
  bool steps_vary_ = true;    // all members can step to any time
  bool noticed_ = false;
};

}  // namespace mebots::master
