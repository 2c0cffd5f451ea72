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

/// A connection of two clocks. If the first clock ticks, the second clock ticks at the same time.
struct ClockLink {
  std::size_t from = 0;  ///< index of the member
  std::size_t to = 0;
  ValueReference from_clock = 0;
  ValueReference to_clock = 0;
};

/// A connection of clocked variables. The value is transferred when clocks of both ends tick at the same time.
struct ClockedLink {
  DiscreteLink link;
  std::vector<ValueReference> from_clocks;
  std::vector<ValueReference> to_clocks;
};

/// Controls the event mode of the instances in a ClockNetwork.
class EventModes {
 public:
  virtual ~EventModes() = default;
  virtual bool is_in_event(std::size_t member) const = 0;
  virtual void enter_event(std::size_t member, double time_s) = 0;
  /// Reports a tick that was delayed to the next communication point.
  virtual void note_late_tick(std::size_t member, double tick_s) = 0;
};

/// Determines when the clocks of connected instances tick, and transfers ticks and values along the connections (FMI
/// 3.0.2, section 2.2.8). Instances without clocks need not be added.
class ClockNetwork final : public SystemClocks {
 public:
  /// `modes` must outlive the network.
  explicit ClockNetwork(EventModes& modes) : modes_(&modes) {}

  /// Adds the clocks of the instance with the index `member`. `slave` and `clocks` must exist until the last call to
  /// this object.
  void add(std::size_t member, HoldingSlave& slave, ClockInstance& clocks);
  void connect(std::vector<ClockLink> clocks, std::vector<ClockedLink> values);
  bool empty() const { return members_.empty(); }

  /// Queries the first ticks of a member's clocks. The member must be in initialization mode.
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
    HoldingSlave* slave = nullptr;  // null if the member has no clocks
    ClockInstance* clocks = nullptr;
    std::vector<TimedClock> timed;
    std::vector<ValueReference> outputs;
    std::set<ValueReference> ticking;  // clocks that tick at the current time
  };

  bool tick(std::size_t member, ValueReference clock, double time_s);
  bool propagate_ticks(double time_s);
  bool propagate_values();

  EventModes* modes_;
  std::vector<Member> members_;
  std::vector<ClockLink> clock_links_;
  std::vector<ClockedLink> value_links_;
  std::vector<std::optional<LinkValue>> sent_;  // values sent at the current time, indexed like value_links_
};

}  // namespace mebots::master
