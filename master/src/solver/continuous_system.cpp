// SPDX-License-Identifier: Apache-2.0
#include "solver/continuous_system.hpp"

#include "mebots/assert.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>
#include <utility>

namespace mebots::master {
namespace {

/// Maximum number of updates of the discrete states at one event.
constexpr int kMostUpdates = 1000;
/// Maximum number of transfers over discrete links between two updates.
constexpr int kMostTransfers = 1000;
/// This many consecutive events within this fraction of a communication step count as an infinite sequence (Zeno
/// behaviour).
constexpr std::size_t kZenoEvents = 20;
constexpr double kZenoShare = 1e-7;
/// Ratio of absolute to relative tolerance for a nominal value of 1, as the FMI standard suggests.
constexpr double kAbsoluteShare = 0.01;

bool same_bits(std::span<const double> a, std::span<const double> b) {
  return std::ranges::equal(
      a, b, [](double x, double y) { return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y); });
}

}  // namespace

void ContinuousSystem::Anchor::visit(state::Visitor& v) {
  v("time_s", time_s);
  v("scale_s", scale_s);
  v("steps", steps);
  v("states", states);
  v("inputs", inputs);
}

ContinuousSystem::ContinuousSystem(Parts parts, const SolverDescription& description)
    : parts_(std::move(parts)), description_(description), wiring_(parts_.members, parts_.wires) {
  std::size_t states = 0;
  std::size_t indicators = 0;
  for (const auto* member : parts_.members) {
    first_states_.push_back(states);
    first_indicators_.push_back(indicators);
    states += member->state_count();
    indicators += member->indicator_count();
    statistics_.members.push_back(member->name());
  }
  states_.resize(states);
  tolerances_.resize(states);
  indicators_.resize(indicators);
  above_.resize(indicators);
  has_jacobian_ = states > 0 && !wiring_.has_loop() && std::ranges::all_of(parts_.members, [](const auto* member) {
                    return member->has_directional_derivatives();
                  });
  statistics_.states = static_cast<std::int64_t>(states);
  statistics_.event_indicators = static_cast<std::int64_t>(indicators);
  statistics_.relative_tolerance = description.relative_tolerance.value_or(parts_.relative_tolerance);
  integrator_ = std::make_unique<Integrator>(static_cast<Equations&>(*this), description.method);
}

std::string ContinuousSystem::subject() const {
  return fmt::format("the continuous system of '{}' at {} s", fmt::join(statistics_.members, "', '"), time_s_);
}

// --- values ---

Evaluation ContinuousSystem::place(double time_s, std::span<const double> states) {
  for (std::size_t m = 0; m < parts_.members.size(); ++m) {
    auto& member = *parts_.members[m];
    member.set_time(time_s);
    const auto own = states.subspan(first_states_[m], member.state_count());
    if (!own.empty() && member.set_states(own) != Evaluation::ok) {
      failure_ = fmt::format("instance '{}' refuses its states at {} s", member.name(), time_s);
      return Evaluation::recoverable;
    }
  }
  if (parts_.inputs != nullptr && parts_.inputs->set_at(time_s) != Evaluation::ok) return Evaluation::recoverable;
  if (wiring_.evaluate() == Evaluation::ok) return Evaluation::ok;
  failure_ = fmt::format("an instance refuses the values of the connections at {} s", time_s);
  return Evaluation::recoverable;
}

/// Sets all members to the current time and states.
void ContinuousSystem::place_exactly() {
  failure_.clear();
  if (place(time_s_, states_) == Evaluation::ok) return;
  throw Error(ErrorCode::fmu_failed, fmt::format("{}: {}", subject(), failure_));
}

Evaluation ContinuousSystem::check_finite(std::size_t member, std::span<const double> derivatives, double time_s) {
  const auto bad = std::ranges::find_if_not(derivatives, [](double value) { return std::isfinite(value); });
  if (bad == derivatives.end()) return Evaluation::ok;
  const auto& instance = *parts_.members[member];
  failure_ = fmt::format("instance '{}' at {} s: the derivative of the state '{}' is {}", instance.name(), time_s,
                         instance.state_name(static_cast<std::size_t>(bad - derivatives.begin())), *bad);
  return Evaluation::recoverable;
}

Evaluation ContinuousSystem::derivatives(double time_s, std::span<const double> states, std::span<double> derivatives) {
  if (place(time_s, states) != Evaluation::ok) return Evaluation::recoverable;
  for (std::size_t m = 0; m < parts_.members.size(); ++m) {
    auto& member = *parts_.members[m];
    const auto own = derivatives.subspan(first_states_[m], member.state_count());
    if (own.empty()) continue;
    if (member.get_derivatives(own) != Evaluation::ok) {
      failure_ = fmt::format("instance '{}' cannot compute its derivatives at {} s", member.name(), time_s);
      return Evaluation::recoverable;
    }
    if (check_finite(m, own, time_s) != Evaluation::ok) return Evaluation::recoverable;
  }
  return Evaluation::ok;
}

Evaluation ContinuousSystem::roots(double time_s, std::span<const double> states, std::span<double> values) {
  if (place(time_s, states) != Evaluation::ok) return Evaluation::recoverable;
  for (std::size_t m = 0; m < parts_.members.size(); ++m) {
    auto& member = *parts_.members[m];
    const auto own = values.subspan(first_indicators_[m], member.indicator_count());
    if (own.empty() || member.get_indicators(own) == Evaluation::ok) continue;
    failure_ = fmt::format("instance '{}' cannot compute its event indicators at {} s", member.name(), time_s);
    return Evaluation::recoverable;
  }
  return Evaluation::ok;
}

Evaluation ContinuousSystem::jacobian(double time_s, std::span<const double> states, const Columns& jacobian) {
  if (place(time_s, states) != Evaluation::ok) return Evaluation::recoverable;
  for (std::size_t m = 0; m < parts_.members.size(); ++m) {
    for (std::size_t s = 0; s < parts_.members[m]->state_count(); ++s) {
      wiring_.propagate(m, s, first_states_, jacobian.column(first_states_[m] + s));
    }
  }
  return Evaluation::ok;
}

/// Detects sign changes of event indicators since the last event, and stores the members that caused them. Necessary
/// because FMI distinguishes z > 0 from z <= 0, and CVODE misses an indicator that starts at zero.
bool ContinuousSystem::has_crossed() {
  if (indicators_.empty()) return false;
  if (roots(time_s_, states_, indicators_) != Evaluation::ok) {
    throw Error(ErrorCode::fmu_failed, fmt::format("{}: {}", subject(), failure_));
  }
  bool crossed = false;
  for (std::size_t i = 0; i < indicators_.size(); ++i) {
    if ((indicators_[i] > 0) == (above_[i] != 0)) continue;
    crossed = true;
    causes_.push_back(member_of_indicator(i));
  }
  return crossed;
}

std::size_t ContinuousSystem::member_of_indicator(std::size_t indicator) const {
  const auto after = std::ranges::upper_bound(first_indicators_, indicator);
  return static_cast<std::size_t>(after - first_indicators_.begin()) - 1;
}

// --- integration ---

std::optional<std::string> ContinuousSystem::initialize(double time_s) {
  MEBOTS_ASSERT(in_event_mode_, "members enter event mode at the end of initialisation");
  time_s_ = time_s;
  point_s_ = time_s;
  iterate_event();
  return terminated_by_.empty() ? std::nullopt : std::optional(terminated_by_);
}

Advanced ContinuousSystem::advance(double end_s) {
  MEBOTS_ASSERT(end_s > time_s_ && !must_repeat_);
  point_s_ = time_s_;
  scale_s_ = end_s - time_s_;
  steps_before_ = statistics_.counts.steps;
  begin_at_point();
  while (terminated_by_.empty() && time_s_ < end_s) {
    if (restart_is_due_) start_solver();
    if (!step_is_open_) take_step();
    if (step_end_s_ > end_s) {
      time_s_ = end_s;
      integrator_->interpolate(end_s, states_);
      place_exactly();
      break;
    }
    if (const auto kind = complete_step(); kind != EventKind::none) handle_event(kind);
  }
  return {time_s_, terminated_by_.empty() ? std::nullopt : std::optional(terminated_by_)};
}

/// Handles changed inputs and due events at the start of advance().
void ContinuousSystem::begin_at_point() {
  causes_.clear();
  if (in_event_mode_) return handle_event(EventKind::input);
  if (next_event_s_ <= time_s_) {
    causes_ = {next_event_member_};
    return handle_event(EventKind::time);
  }
  if (description_.restarts_at_points) restart_is_due_ = true;
  if (!restart_is_due_) return;
  place_exactly();
  if (has_crossed()) handle_event(EventKind::state);
}

void ContinuousSystem::start_solver() {
  anchor_ = {.time_s = time_s_, .scale_s = scale_s_, .steps = 0, .states = states_, .inputs = {}};
  anchor_.inputs.assign(wiring_.inputs().begin(), wiring_.inputs().end());
  restart_is_due_ = false;
  step_is_open_ = false;
  ++statistics_.counts.restarts;
  restart_from_anchor();
}

void ContinuousSystem::restart_from_anchor() {
  wiring_.set_loop_start(anchor_.inputs);
  std::optional<double> stop_s;
  for (const auto time_s : {next_event_s_, parts_.latest_s.value_or(kNoEvent)}) {
    if (time_s != kNoEvent && time_s > anchor_.time_s) stop_s = std::min(time_s, stop_s.value_or(time_s));
  }
  integrator_->restart({.time_s = anchor_.time_s,
                        .states = anchor_.states,
                        .absolute_tolerances = tolerances_,
                        .relative_tolerance = statistics_.relative_tolerance,
                        .scale_s = anchor_.scale_s,
                        .max_step_s = description_.max_step_s.value_or(anchor_.scale_s),
                        .stop_time_s = stop_s});
  counted_ = {};
}

void ContinuousSystem::take_step() {
  stop_if_interrupted(*parts_.interrupted);
  if (statistics_.counts.steps - steps_before_ >= description_.max_steps) {
    throw Error(
        ErrorCode::not_converged,
        fmt::format("{}: the solver has taken {} steps in one communication step of {} s. Raise \"max_steps\" in "
                    "\"solver\", or set larger tolerances",
                    subject(), description_.max_steps, scale_s_));
  }
  failure_.clear();
  ended_at_root_ = integrator_->advance() == Integrator::Reached::root;
  step_end_s_ = integrator_->time_s();
  step_is_open_ = true;
  ++anchor_.steps;
  ++statistics_.counts.steps;
  count_solver_work();
}

void ContinuousSystem::count_solver_work() {
  const auto now = integrator_->counts();
  statistics_.counts.rejected_steps += now.rejected_steps - counted_.rejected_steps;
  statistics_.counts.evaluations += now.evaluations - counted_.evaluations;
  statistics_.counts.jacobians += now.jacobians - counted_.jacobians;
  counted_ = now;
}

/// Sets the time and states of the members to those at the end of the solver step. Returns the kind of event at this
/// time.
ContinuousSystem::EventKind ContinuousSystem::complete_step() {
  step_is_open_ = false;
  time_s_ = step_end_s_;
  std::ranges::copy(integrator_->states(), states_.begin());
  place_exactly();
  causes_.clear();
  bool requested = false;
  for (std::size_t m = 0; m < parts_.members.size(); ++m) {
    auto& member = *parts_.members[m];
    if (!member.needs_completed_step()) continue;
    const auto answer = member.completed_step();
    if (answer.terminate && terminated_by_.empty()) terminated_by_ = member.name();
    if (!answer.enter_event_mode) continue;
    requested = true;
    causes_.push_back(m);
  }
  return event_after_step(requested);
}

ContinuousSystem::EventKind ContinuousSystem::event_after_step(bool requested) {
  if (ended_at_root_) {
    for (std::size_t i = 0; i < indicators_.size(); ++i) {
      if (integrator_->is_root(i)) causes_.push_back(member_of_indicator(i));
    }
    return EventKind::state;
  }
  if (next_event_s_ <= time_s_) {
    causes_.push_back(next_event_member_);
    return EventKind::time;
  }
  if (has_crossed()) return EventKind::state;
  return requested ? EventKind::step : EventKind::none;
}

// --- events ---

void ContinuousSystem::enter_event_mode() {
  if (in_event_mode_) return;
  for (auto* member : parts_.members) member->enter_event_mode();
  in_event_mode_ = true;
}

void ContinuousSystem::handle_event(EventKind kind) {
  MEBOTS_ASSERT(kind != EventKind::none);
  count_event(kind);
  if (kind == EventKind::step) return handle_step_event();
  if (kind != EventKind::input) limit_events();
  enter_event_mode();
  iterate_event();
}

/// Handles a step event. Some FMUs request an event after every step, and restarts would keep the solver at its
/// shortest steps. Therefore the solver restarts only if the event changed data on which the solver depends. CVODE
/// compares event indicators with their values before the event, so a changed sign also requires a restart.
void ContinuousSystem::handle_step_event() {
  const auto requested_by = causes_;
  const auto before = solver_view();
  enter_event_mode();
  iterate_event();
  if (!terminated_by_.empty()) return;
  if (before && before == solver_view()) {
    restart_is_due_ = false;
    return;
  }
  causes_ = requested_by;
  limit_events();
}

/// Returns the values on which the solver depends. Returns nullopt if a member cannot compute them.
std::optional<ContinuousSystem::SolverView> ContinuousSystem::solver_view() {
  SolverView view{states_, tolerances_, std::vector<double>(states_.size()), next_event_s_, above_};
  if (derivatives(time_s_, states_, view.derivatives) != Evaluation::ok) return std::nullopt;
  return view;
}

void ContinuousSystem::count_event(EventKind kind) {
  auto& counts = statistics_.counts;
  switch (kind) {
    case EventKind::none:
      break;
    case EventKind::input:
      ++counts.input_events;
      break;
    case EventKind::state:
      ++counts.state_events;
      break;
    case EventKind::time:
      ++counts.time_events;
      break;
    case EventKind::step:
      ++counts.step_events;
      break;
  }
}

/// Throws Error if events repeat without progress in time.
void ContinuousSystem::limit_events() {
  recent_events_s_.push_back(time_s_);
  if (recent_events_s_.size() <= kZenoEvents) return;
  recent_events_s_.erase(recent_events_s_.begin());
  if (time_s_ - recent_events_s_.front() > kZenoShare * scale_s_) return;
  throw Error(ErrorCode::not_converged,
              fmt::format("{}: {} events follow each other within {} s, as if without end; the last ones are of {}. "
                          "Give the model a state of rest, or a hysteresis",
                          subject(), kZenoEvents, time_s_ - recent_events_s_.front(), causes()));
}

std::string ContinuousSystem::causes() const {
  std::set<std::string> names;
  for (const auto member : causes_) names.insert(statistics_.members[member]);
  return fmt::format("'{}'", fmt::join(names, "', '"));
}

/// Updates the discrete states until no member needs another update and no connection changes a value.
void ContinuousSystem::iterate_event() {
  propagate_in_event();
  for (int update = 0; update < kMostUpdates; ++update) {
    tick_clocks();
    const bool again = update_members();
    if (!terminated_by_.empty()) return;
    const bool changed = propagate_in_event();
    if (!again && !changed) return leave_event_mode();
    if (changed && causes_.empty()) causes_ = {0};
  }
  throw Error(
      ErrorCode::not_converged,
      fmt::format("{}: the event does not end within {} updates of the discrete states; these instances request "
                  "another update: {}",
                  subject(), kMostUpdates, causes()));
}

/// Activates the clocks whose next tick is scheduled for the current time, and propagates ticks and values until
/// nothing changes.
void ContinuousSystem::tick_clocks() {
  if (parts_.clocks == nullptr) return;
  bool changed = parts_.clocks->begin_instant(time_s_);
  for (int transfer = 0; transfer < kMostTransfers; ++transfer) {
    if (!parts_.clocks->propagate(time_s_) && !changed) return;
    changed = propagate_in_event();
  }
  throw Error(ErrorCode::algebraic_loop,
              fmt::format("{}: clocked values still change along the connections after {} transfers in one event",
                          subject(), kMostTransfers));
}

/// Updates the discrete states of all members. Returns true if a member needs another update, or if a clock ticks again
/// at this time.
bool ContinuousSystem::update_members() {
  bool again = false;
  next_event_s_ = kNoEvent;
  causes_.clear();
  for (std::size_t m = 0; m < parts_.members.size(); ++m) {
    if (parts_.clocks != nullptr) parts_.clocks->before_update(m);
    const auto result = parts_.members[m]->update_discrete_states();
    if (parts_.clocks != nullptr) parts_.clocks->after_update(m, time_s_);
    if (result.terminate && terminated_by_.empty()) terminated_by_ = parts_.members[m]->name();
    if (result.needs_another) {
      again = true;
      causes_.push_back(m);
    }
    if (!result.next_event_s || !(*result.next_event_s < next_event_s_)) continue;
    next_event_s_ = *result.next_event_s;
    next_event_member_ = m;
  }
  return (parts_.clocks != nullptr && schedule_tick()) || again;
}

/// Makes the solver stop at the next tick of a clock. Returns true if the tick is due now.
bool ContinuousSystem::schedule_tick() {
  const auto tick = parts_.clocks->next_tick();
  const double tick_s = on_grid(tick.time_s);
  if (tick_s < next_event_s_) {
    next_event_s_ = tick_s;
    next_event_member_ = tick.member;
  }
  if (tick_s > time_s_) return false;
  causes_.push_back(tick.member);
  return true;
}

/// Rounds a time to a communication point within kSameTime_s, or returns the time unchanged. Without rounding, a tick
/// at 3 * 0.1 s would occur one step after the point 0.3 s.
double ContinuousSystem::on_grid(double time_s) const {
  constexpr double kLatest_s = 9e9;  // nanoseconds of later times may not fit into 64 bits
  if (!(time_s < kLatest_s)) return time_s;
  const double point_s = parts_.grid.time_s(std::llround(time_s * 1e9));
  return std::abs(point_s - time_s) <= kSameTime_s ? point_s : time_s;
}

/// Transfers values over all connections until no discrete input changes. Returns true if an input has changed.
bool ContinuousSystem::propagate_in_event() {
  const std::vector<double> before(wiring_.inputs().begin(), wiring_.inputs().end());
  bool changed = false;
  for (int transfer = 0; transfer < kMostTransfers; ++transfer) {
    if (wiring_.evaluate() != Evaluation::ok) {
      throw Error(ErrorCode::fmu_failed,
                  fmt::format("{}: an instance refuses the values of the connections", subject()));
    }
    if (parts_.discrete == nullptr || !parts_.discrete->transfer()) {
      return changed || !same_bits(before, wiring_.inputs());
    }
    changed = true;
  }
  throw Error(ErrorCode::algebraic_loop,
              fmt::format("{}: discrete values along the connections still change after {} transfers", subject(),
                          kMostTransfers));
}

void ContinuousSystem::leave_event_mode() {
  std::vector<double> nominals;
  const double absolute = description_.absolute_tolerance.value_or(kAbsoluteShare * statistics_.relative_tolerance);
  for (std::size_t m = 0; m < parts_.members.size(); ++m) {
    auto& member = *parts_.members[m];
    member.enter_continuous_time_mode();
    if (member.state_count() == 0) continue;
    member.get_states(std::span(states_).subspan(first_states_[m], member.state_count()));
    nominals.assign(member.state_count(), 1.0);
    member.get_nominals(nominals);
    std::ranges::transform(nominals, tolerances_.begin() + static_cast<std::ptrdiff_t>(first_states_[m]),
                           [&](double nominal) {
                             const bool is_usable = std::isfinite(nominal) && nominal != 0;
                             return absolute * (is_usable ? std::abs(nominal) : 1.0);
                           });
  }
  in_event_mode_ = false;
  restart_is_due_ = true;
  has_crossed();
  std::ranges::transform(indicators_, above_.begin(), [](double value) { return value > 0 ? 1 : 0; });
}

// --- states ---

void ContinuousSystem::visit(state::Visitor& v) {
  v("time_s", time_s_);
  v("states", states_);
  v("point_s", point_s_);
  v("step_end_s", step_end_s_);
  v("step_is_open", step_is_open_);
  v("ended_at_root", ended_at_root_);
  v("restart_is_due", restart_is_due_);
  v("in_event_mode", in_event_mode_);
  v("next_event_s", next_event_s_);
  v("next_event_member", next_event_member_);
  v("above", above_);
  v("tolerances", tolerances_);
  v("recent_events_s", recent_events_s_);
  v("anchor", anchor_);
  v("counts", statistics_.counts);
  if (v.restores()) must_repeat_ = true;
}

bool ContinuousSystem::repeat_steps(const std::function<std::function<void()>()>& keep) {
  must_repeat_ = false;
  if (restart_is_due_ || in_event_mode_ || description_.restarts_at_points) return true;
  const auto put_back = keep();
  restart_from_anchor();
  for (std::int64_t step = 0; step < anchor_.steps; ++step) integrator_->advance();
  counted_ = integrator_->counts();
  std::vector<double> states(integrator_->states().begin(), integrator_->states().end());
  const bool same_end = integrator_->time_s() == step_end_s_;
  if (same_end && step_is_open_) integrator_->interpolate(time_s_, states);
  put_back();
  if (same_end && same_bits(states, states_)) return true;
  restart_is_due_ = true;
  step_is_open_ = false;
  return false;
}

}  // namespace mebots::master
