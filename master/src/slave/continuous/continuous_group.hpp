// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/time_grid.hpp"
#include "message/message_hub.hpp"
#include "slave/clocked/clock_network.hpp"
#include "slave/continuous/continuous_slave.hpp"
#include "solver/continuous_system.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master {

/// Steps the slaves of one continuous system. The step of the first slave advances the whole system. The steps of the
/// other slaves return the same result.
class ContinuousGroup final : private DiscreteLinks, private OuterInputs, private EventModes {
 public:
  struct Setup {
    SolverDescription solver;
    double relative_tolerance = 1e-6;  ///< applies if the solver description contains no tolerance
    TimeGrid grid;
    MessageSink* messages = nullptr;
    const std::atomic<bool>* interrupted = &kNeverInterrupted;
    SolverStatistics* statistics = nullptr;  ///< null: collects no statistics
  };

  /// All objects to which the members of `setup` point must outlive the group.
  explicit ContinuousGroup(Setup setup) : setup_(std::move(setup)) {}

  /// Adds a slave and returns its index among the members. The slave must exist until the last call of the group.
  std::size_t add(ContinuousSlave& slave);
  /// Connects the members. Must be called before the first member exits initialization mode.
  void connect(std::vector<Wire> wires, std::vector<DiscreteLink> links);
  /// Returns the clocks of all members. If a member has clocks, its ContinuousSlave must wrap a HoldingSlave.
  ClockNetwork& clocks() { return clocks_; }

  void setup_experiment(const Experiment& experiment);
  /// Queries the first ticks of a member's clocks. The member must be in initialization mode.
  void start_clocks(std::size_t member) { clocks_.start(member, setup_.grid.time_s(experiment_.start_ns)); }
  /// Must be called once for each member after the member has exited initialization mode. The last call handles the
  /// events at the start.
  void exit_initialization();
  bool is_integrating() const { return system_ != nullptr; }
  StepResult step(std::int64_t start_ns, std::int64_t duration_ns);

  /// Must be called if a discrete input (enter_event_mode) or a continuous input (input_changed) of a member changes.
  void enter_event_mode() { system_->enter_event_mode(); }
  void input_changed() { system_->input_changed(); }

  /// Returns the state of the solver as bytes, for restore().
  std::vector<std::byte> save() const;
  void restore(std::span<const std::byte> bytes);
  void visit(state::Visitor& v);

 private:
  // The instances need no individual event mode, because all members enter event mode together before a clock ticks.
  bool is_in_event(std::size_t /*member*/) const override { return true; }
  void enter_event(std::size_t /*member*/, double /*time_s*/) override {}
  void note_late_tick(std::size_t /*member*/, double /*tick_s*/) override {}

  bool transfer() override;
  Evaluation set_at(double time_s) override;
  void advance(std::int64_t start_ns, std::int64_t duration_ns);
  void repeat_steps();
  std::function<void()> keep_members();
  void report() const;

  Setup setup_;
  std::vector<ContinuousSlave*> members_;
  std::vector<Wire> wires_;
  std::vector<DiscreteLink> links_;
  ClockNetwork clocks_{*this};
  Experiment experiment_;
  std::size_t initialised_ = 0;
  std::optional<std::string> terminated_by_;
  std::unique_ptr<ContinuousSystem> system_;
  StepResult result_;         // result of the current step for all members
  std::size_t given_to_ = 0;  // number of members that received result_; 0: the next call advances the system
};

}  // namespace mebots::master
