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

/// The connections within a continuous system that transfer values only in event mode: those of discrete Reals,
/// Integers, Booleans and texts.
class DiscreteLinks {
 public:
  virtual ~DiscreteLinks() = default;
  /// Transfers all values. Returns true if an input has changed.
  virtual bool transfer() = 0;
};

/// Continuous inputs from outside the system that change within a communication step.
class OuterInputs {
 public:
  virtual ~OuterInputs() = default;
  /// Sets the inputs to their values at this time.
  virtual Evaluation set_at(double time_s) = 0;
};

struct Advanced {
  double time_s = 0;
  /// Name of the member that requested the end of the run, or nullopt.
  std::optional<std::string> terminated_by = {};
};

/// Connected model exchange instances that one solver integrates. The solver keeps its order and step size across
/// communication points, except after a restart. If a solver step extends past a communication point, the system
/// interpolates the solution at this point and completes the step later. Members must be in event mode before
/// initialize().
class ContinuousSystem final : private Equations {
 public:
  struct Parts {
    std::vector<ContinuousInstance*> members;
    std::vector<Wire> wires;
    DiscreteLinks* discrete = nullptr;  ///< null without discrete connections
    OuterInputs* inputs = nullptr;      ///< null if no input from outside changes with time
    SystemClocks* clocks = nullptr;     ///< null if no member has clocks
    TimeGrid grid = {};
    double relative_tolerance = 1e-6;     ///< used if the solver description contains no tolerance
    std::optional<double> latest_s = {};  ///< latest time at which members may be evaluated [s]
    const std::atomic<bool>* interrupted = &kNeverInterrupted;
  };

  /// All objects in `parts` must outlive the system.
  ContinuousSystem(Parts parts, const SolverDescription& description);

  /// Handles the events at the start and enters continuous-time mode. Returns the name of the member that requested the
  /// end of the run, or nullopt.
  std::optional<std::string> initialize(double time_s);
  /// Integrates to `end_s` and handles all events. Stops earlier if a member requests the end of the run. Throws Error
  /// if an instance fails, if a value is NaN or infinite, if the solver or an event iteration does not converge, or if
  /// there are too many steps or events. Throws InterruptedError after an interrupt.
  Advanced advance(double end_s);
  double time_s() const { return time_s_; }
  /// Returns the time at which the latest advance() started [s].
  double point_s() const { return point_s_; }

  /// Makes the solver restart at the current time. Must be called after a continuous input from outside has changed.
  void input_changed() { restart_is_due_ = true; }
  /// Makes all members enter event mode, so that discrete inputs can be set. The next advance() starts with an event.
  void enter_event_mode();
  bool in_event_mode() const { return in_event_mode_; }

  const SolverStatistics& statistics() const { return statistics_; }

  /// Saves or restores the state of the solver. The states of the members must be restored first.
  void visit(state::Visitor& v);
  /// Repeats the solver's steps since its last start, so that later steps of a restored run have the same bits. If not
  /// called after a restore, the next advance() repeats the steps. `keep` must save the states of the members and
  /// return a function that restores them. Returns false if the repetition ends in different states, because a member
  /// depends on more than time, states and inputs. Then the solver restarts at the current time.
  bool repeat_steps(const std::function<std::function<void()>()>& keep);
  bool must_repeat() const { return must_repeat_; }

 private:
  /// The point at which the solver last started.
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

  double time_s_ = 0;           // current time of the members [s]
  std::vector<double> states_;  // states at time_s_
  double point_s_ = 0;
  double step_end_s_ = 0;       // end of the last solver step [s]
  bool step_is_open_ = false;   // true if the last solver step ends after time_s_ and is not completed
  bool ended_at_root_ = false;  // true if the last solver step ended at a root
  bool restart_is_due_ = false;
  bool in_event_mode_ = true;
  double next_event_s_ = kNoEvent;
  std::vector<double> indicators_;
  std::vector<std::uint8_t> above_;  // indexed by indicator; true if the indicator was positive after the last event
  std::vector<double> tolerances_;   // absolute tolerances
  std::vector<double> recent_events_s_;
  Anchor anchor_;

  bool must_repeat_ = false;
  std::int64_t steps_before_ = 0;  // number of solver steps before this advance()
  double scale_s_ = 1;             // duration of this advance() [s]
  std::string failure_;
  std::string terminated_by_;
  std::vector<std::size_t> causes_;  // members that caused the last event
  std::size_t next_event_member_ = 0;
  Integrator::Counts counted_;  // operations since the last start that are already in statistics_
  std::unique_ptr<Integrator> integrator_;
};

}  // namespace mebots::master
