// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "slave/clocked/holding_slave.hpp"
#include "slave/clocked/timed_clock.hpp"
#include "solver/system_clocks.hpp"

#include <cstddef>
#include <optional>
#include <set>
#include <vector>

namespace mebots::master {

/// A connection of clocks: whenever the first clock ticks, the second clock ticks at the same instant.
struct ClockLink {
  std::size_t from = 0;  ///< index of the member
  std::size_t to = 0;
  ValueReference from_clock = 0;
  ValueReference to_clock = 0;
};

/// A connection of clocked variables. Its value is transferred at instants at which the clocks of both ends tick.
struct ClockedLink {
  DiscreteLink link;
  std::vector<ValueReference> from_clocks;
  std::vector<ValueReference> to_clocks;
};

/// The interface through which a network controls the event modes of its members.
class EventModes {
 public:
  virtual ~EventModes() = default;
  virtual bool is_in_event(std::size_t member) const = 0;
  /// Makes a member enter event mode, because one of its clocks ticks.
  virtual void enter_event(std::size_t member, double time_s) = 0;
  /// Reports a tick that had to wait for a communication point.
  virtual void note_late_tick(std::size_t member, double tick_s) = 0;
};

/// Determines when the clocks of connected instances tick, and transfers ticks and values along the connections at one
/// instant (FMI 3.0.2, section 2.2.8). Members without clocks need not be added.
class ClockNetwork final : public SystemClocks {
 public:
  /// `modes` must outlive the network.
  explicit ClockNetwork(EventModes& modes) : modes_(&modes) {}

  /// Adds the clocks of a member of the group. `member` is its index in the group. `slave` and `clocks` must exist
  /// until the last call of the network.
  void add(std::size_t member, HoldingSlave& slave, ClockInstance& clocks);
  void connect(std::vector<ClockLink> clocks, std::vector<ClockedLink> values);
  bool empty() const { return members_.empty(); }

  /// Queries the first ticks of the clocks of a member, which must be in initialization mode.
  void start(std::size_t member, double start_s);
  bool is_due(double time_s) const { return next_tick().time_s <= time_s + kSameTime_s; }

  Tick next_tick() const override;
  bool begin_instant(double time_s) override;
  bool propagate(double time_s) override;
  void before_update(std::size_t member) override;
  void after_update(std::size_t member, double time_s) override;

  void visit(state::Visitor& v);

 private:
  struct Member {
    HoldingSlave* slave = nullptr;  // null for a member without clocks
    ClockInstance* clocks = nullptr;
    std::vector<TimedClock> timed;
    std::vector<ValueReference> outputs;  // output clocks
    std::set<ValueReference> ticking;     // clocks that tick at this instant
  };

  bool tick(std::size_t member, ValueReference clock, double time_s);
  bool propagate_ticks(double time_s);
  bool propagate_values();

  EventModes* modes_;
  std::vector<Member> members_;
  std::vector<ClockLink> clock_links_;
  std::vector<ClockedLink> value_links_;
  std::vector<std::optional<LinkValue>> sent_;  // values that were sent at this instant, indexed by value link
};

}  // namespace mebots::master
