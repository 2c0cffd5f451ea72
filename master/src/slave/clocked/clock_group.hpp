// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/time_grid.hpp"
#include "message/message_hub.hpp"
#include "slave/clocked/clock_network.hpp"
#include "slave/clocked/event_instance.hpp"
#include "slave/slave.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master {

/// Steps co-simulation slaves whose clocks are connected, or a single slave with clocks. Handles clock ticks and events
/// (FMI 3.0.2, sections 2.2.8 and 4.2.1). The step of the first member advances the whole group.
///
/// Members step one after the other. If a member returns early because of an event, later members step only to the time
/// of this event. Members that have already stepped further handle the event at their own, later time. If a member
/// cannot vary the length of its step (canHandleVariableCommunicationStepSize = false), clocks tick only at
/// communication points.
class ClockGroup final : private EventModes {
 public:
  /// `messages` must outlive the group.
  ClockGroup(const TimeGrid& grid, MessageSink& messages) : grid_(grid), messages_(&messages) {}

  /// Adds an instance, given by its two interfaces, and returns its index among the members. Both objects must exist
  /// until the last call of the group.
  std::size_t add(HoldingSlave& slave, EventInstance& instance);
  /// Connects clocks and clocked variables. Must be called before the first member exits initialization mode.
  void connect(std::vector<ClockLink> clocks, std::vector<ClockedLink> values) {
    network_.connect(std::move(clocks), std::move(values));
  }

  void setup_experiment(const Experiment& experiment) { start_ns_ = experiment.start_ns; }
  /// Queries the first ticks of a member's clocks. The member must be in initialization mode.
  void start_clocks(std::size_t member);
  /// Must be called once for each member after the member has exited initialization mode. The last call handles the
  /// events at the start.
  void exit_initialization();
  StepResult step(std::int64_t start_ns, std::int64_t duration_ns);
  /// Returns the time of the next tick of any clock in seconds; TimedClock::kNever if no tick is scheduled.
  double next_tick_s() const { return network_.next_tick().time_s; }

  /// Returns the times of members and clocks as bytes, for restore().
  std::vector<std::byte> save() const;
  void restore(std::span<const std::byte> bytes);
  void visit(state::Visitor& v);

 private:
  struct Member {
    EventInstance* instance = nullptr;
    double time_s = 0;
    bool needs_event = false;
    bool in_event = false;
  };

  bool is_in_event(std::size_t member) const override { return members_[member].in_event; }
  void enter_event(std::size_t member, double time_s) override;
  void note_late_tick(std::size_t member, double tick_s) override;

  StepResult advance(double end_s);
  StepResult step_members(double& target_s);
  bool is_anything_due(double time_s) const;
  bool handle_events(double time_s);
  void notice(const Member& member, double time_s, const std::string& text);
  [[noreturn]] void fail_to_rest(double time_s) const;
  bool update_members(double time_s, bool& terminated);

  TimeGrid grid_;
  MessageSink* messages_;
  std::vector<Member> members_;
  ClockNetwork network_{*this};
  std::int64_t start_ns_ = 0;
  std::size_t initialised_ = 0;
  bool ended_ = false;        // true if a member requested the end of the simulation at the start
  StepResult result_;         // result of the current step for all members
  std::size_t given_to_ = 0;  // number of members that received result_; 0: the next call advances the group
  bool steps_vary_ = true;    // true if all members can step to any time
  bool noticed_ = false;
};

}  // namespace mebots::master
