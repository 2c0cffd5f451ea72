// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/signal_guard.hpp"
#include "base/time_grid.hpp"
#include "mebots/state/visitor.hpp"
#include "model/solver_description.hpp"
#include "model/solver_statistics.hpp"
#include "solver/integrator.hpp"
#include "solver/system_clocks.hpp"
#include "solver/wiring.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mebots::master {

/// The connections of a continuous system that transfer values only in event mode. They connect discrete Reals,
/// Integers, Booleans and texts.
class DiscreteLinks {
 public:
  virtual ~DiscreteLinks() = default;
  /// Transfers the values. Returns true if an input has changed.
  virtual bool transfer() = 0;
};

/// The continuous inputs whose values come from outside of the system and change within a communication step.
class OuterInputs {
 public:
  virtual ~OuterInputs() = default;
  /// Sets these inputs to their values at this time.
  virtual Evaluation set_at(double time_s) = 0;
};

/// Describes the result of ContinuousSystem::advance().
struct Advanced {
  double time_s = 0;
  /// Name of the member that requested the end of the simulation; nullopt if no member requested it.
  std::optional<std::string> terminated_by = {};
};

/// Connected instances that one solver integrates. The solver keeps its order and step size across communication
/// points, except at restarts. If a solver step extends beyond a communication point, the solution is interpolated at
/// this point. The step is completed when the system reaches the end of the step. Members must be in event mode before
/// initialize().
class ContinuousSystem final : private Equations {
 public:
  struct Parts {
    std::vector<ContinuousInstance*> members;
    std::vector<Wire> wires;
    DiscreteLinks* discrete = nullptr;    ///< null if there are no such connections
    OuterInputs* inputs = nullptr;        ///< null if no input depends on time
    SystemClocks* clocks = nullptr;       ///< null if no member has clocks
    TimeGrid grid = {};                   ///< the communication points
    double relative_tolerance = 1e-6;     ///< used if the solver description contains none
    std::optional<double> latest_s = {};  ///< latest time at which the system may be evaluated
    const std::atomic<bool>* interrupted = &kNeverInterrupted;
  };

  /// All objects to which `parts` points must outlive the system.
  ContinuousSystem(Parts parts, const SolverDescription& description);

  /// Iterates the events at the start, and enters continuous-time mode. Returns the name of the member that requested
  /// the end of the simulation. Returns nullopt if no member did.
  std::optional<std::string> initialize(double time_s);
  /// Integrates to `end_s` and handles all events up to this time. Afterwards, all members are at `end_s`, or at the
  /// time at which a member requested the end of the simulation. Throws Error if an instance fails, if values are not
  /// finite, if the solver or an event iteration does not converge, or if there are too many steps or events. Throws
  /// InterruptedError after an interrupt.
  Advanced advance(double end_s);
  double time_s() const { return time_s_; }
  /// Returns the communication point at which the current or last call of advance() started [s].
  double point_s() const { return point_s_; }

  /// Must be called if a continuous input from outside has changed. Makes the solver restart at the current time.
  void input_changed() { restart_is_due_ = true; }
  /// Makes all members enter event mode at the current time, so that discrete inputs can be set. The next advance()
  /// starts with an event.
  void enter_event_mode();
  bool in_event_mode() const { return in_event_mode_; }

  const SolverStatistics& statistics() const { return statistics_; }

  /// Visits the state of the solver. Before a restore, the states of the members must have been restored.
  void visit(state::Visitor& v);
  /// Repeats, after a restore, the steps of the solver since its last start, so that the following steps have the same
  /// bits. If this function is not called, the next advance() repeats them. `keep` must save the states of the members,
  /// and must return a function that restores them. Returns false if the repetition ends in different states, because a
  /// member depends on more than time, states and inputs. In this case, the solver restarts at the current time.
  bool repeat_steps(const std::function<std::function<void()>()>& keep);
  bool must_repeat() const { return must_repeat_; }

 private:
  /// The point at which the solver was last started.
  struct Anchor {
    double time_s = 0;
    double scale_s = 0;
    std::int64_t steps = 0;  ///< number of steps since the start
    std::vector<double> states;
    std::vector<double> inputs;

    void visit(state::Visitor& v);
  };
  enum class EventKind { none, state, time, step, input };
  struct SolverView {
    std::vector<double> states;
    std::vector<double> tolerances;
    std::vector<double> derivatives;
    double next_event_s;
    std::vector<std::uint8_t> above;

    bool operator==(const SolverView&) const = default;
  };
  static constexpr double kNoEvent = std::numeric_limits<double>::infinity();

  std::size_t state_count() const override { return states_.size(); }
  std::size_t root_count() const override { return indicators_.size(); }
  Evaluation derivatives(double time_s, std::span<const double> states, std::span<double> derivatives) override;
  Evaluation roots(double time_s, std::span<const double> states, std::span<double> values) override;
  bool has_jacobian() const override { return has_jacobian_; }
  Evaluation jacobian(double time_s, std::span<const double> states, const Columns& jacobian) override;
  std::string failure() const override { return failure_; }

  std::string subject() const override;

  Evaluation place(double time_s, std::span<const double> states);
  void place_exactly();
  Evaluation check_finite(std::size_t member, std::span<const double> derivatives, double time_s);
  bool has_crossed();
  void begin_at_point();
  void take_step();
  EventKind complete_step();
  EventKind event_after_step(bool requested);
  void handle_event(EventKind kind);
  void handle_step_event();
  std::optional<SolverView> solver_view();
  void iterate_event();
  bool update_members();
  bool schedule_tick();
  double on_grid(double time_s) const;
  void tick_clocks();
  bool propagate_in_event();
  void leave_event_mode();
  void start_solver();
  void restart_from_anchor();
  void count_solver_work();
  void count_event(EventKind kind);
  void limit_events();
  std::size_t member_of_indicator(std::size_t indicator) const;
  std::string causes() const;

  Parts parts_;
  SolverDescription description_;
  Wiring wiring_;
  std::vector<std::size_t> first_states_;      // indexed by member
  std::vector<std::size_t> first_indicators_;  // indexed by member
  bool has_jacobian_ = false;
  SolverStatistics statistics_;

  double time_s_ = 0;           // time of the members' current point or event
  std::vector<double> states_;  // states at time_s_
  double point_s_ = 0;
  double step_end_s_ = 0;       // end of the solver's last step
  bool step_is_open_ = false;   // true if the last step extends beyond time_s_ and is not completed
  bool ended_at_root_ = false;  // true if the last step ended at a root
  bool restart_is_due_ = false;
  bool in_event_mode_ = true;
  double next_event_s_ = kNoEvent;
  std::vector<double> indicators_;
  std::vector<std::uint8_t> above_;  // indexed by indicator; true if it was above zero after the last event
  std::vector<double> tolerances_;   // absolute tolerances
  std::vector<double> recent_events_s_;
  Anchor anchor_;

  bool must_repeat_ = false;
  std::int64_t steps_before_ = 0;  // number of steps at the start of this advance()
  double scale_s_ = 1;             // duration of this advance()
  std::string failure_;
  std::string terminated_by_;
  std::vector<std::size_t> causes_;  // members that caused the last event
  std::size_t next_event_member_ = 0;
  Integrator::Counts counted_;  // operations of the integrator since its last start that statistics_ already contains
  std::unique_ptr<Integrator> integrator_;
};

}  // namespace mebots::master
