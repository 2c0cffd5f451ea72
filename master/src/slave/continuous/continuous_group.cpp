// SPDX-License-Identifier: Apache-2.0
#include "slave/continuous/continuous_group.hpp"

#include "base/time.hpp"
#include "mebots/assert.hpp"
#include "mebots/state/save.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mebots::master {

std::size_t ContinuousGroup::add(ContinuousSlave& slave) {
  members_.push_back(&slave);
  return members_.size() - 1;
}

void ContinuousGroup::connect(std::vector<Wire> wires, std::vector<DiscreteLink> links) {
  wires_ = std::move(wires);
  links_ = std::move(links);
}

void ContinuousGroup::setup_experiment(const Experiment& experiment) {
  experiment_.start_ns = experiment.start_ns;
  if (!experiment.stop_ns) return;
  experiment_.stop_ns = std::min(*experiment.stop_ns, experiment_.stop_ns.value_or(*experiment.stop_ns));
}

void ContinuousGroup::exit_initialization() {
  if (++initialised_ < members_.size()) return;
  ContinuousSystem::Parts parts;
  for (auto* member : members_) parts.members.push_back(&member->instance());
  parts.wires = wires_;
  if (!links_.empty()) parts.discrete = this;
  parts.inputs = this;
  if (!clocks_.empty()) parts.clocks = &clocks_;
  parts.grid = setup_.grid;
  parts.relative_tolerance = setup_.relative_tolerance;
  if (experiment_.stop_ns) parts.latest_s = setup_.grid.time_s(*experiment_.stop_ns);
  parts.interrupted = setup_.interrupted;
  system_ = std::make_unique<ContinuousSystem>(std::move(parts), setup_.solver);
  terminated_by_ = system_->initialize(setup_.grid.time_s(experiment_.start_ns));
  if (setup_.statistics != nullptr) *setup_.statistics = system_->statistics();
}

void ContinuousGroup::report() const {
  if (setup_.statistics != nullptr) setup_.statistics->counts = system_->statistics().counts;
}

StepResult ContinuousGroup::step(std::int64_t start_ns, std::int64_t duration_ns) {
  MEBOTS_ASSERT(is_integrating());
  if (given_to_ == 0) advance(start_ns, duration_ns);
  if (++given_to_ == members_.size()) given_to_ = 0;
  return result_;
}

void ContinuousGroup::advance(std::int64_t start_ns, std::int64_t duration_ns) {
  if (system_->must_repeat()) repeat_steps();
  result_ = {};
  Advanced reached{.time_s = system_->time_s(), .terminated_by = terminated_by_};
  if (!terminated_by_) reached = system_->advance(setup_.grid.time_s(start_ns + duration_ns));
  report();
  if (!reached.terminated_by) return;
  result_.done = false;
  result_.terminated = true;
  result_.last_successful_s = reached.time_s;
}

Evaluation ContinuousGroup::set_at(double time_s) {
  for (auto* member : members_) {
    if (!member->has_courses()) continue;
    if (member->set_courses(time_s - system_->point_s()) != Evaluation::ok) return Evaluation::recoverable;
  }
  return Evaluation::ok;
}

bool ContinuousGroup::transfer() {
  bool changed = false;
  for (const auto& link : links_) {
    const auto value = link.read(members_[link.from]->alone());
    changed |= members_[link.to]->set_in_event(link.to_kind, link.to_reference, value);
  }
  return changed;
}

void ContinuousGroup::visit(state::Visitor& v) {
  v("system", *system_);
  v("clocks", clocks_);
}

std::vector<std::byte> ContinuousGroup::save() const {
  return state::save(*this);
}

void ContinuousGroup::restore(std::span<const std::byte> bytes) {
  state::restore(*this, bytes);
  given_to_ = 0;
  terminated_by_.reset();
  report();
}

/// Saves the states of all instances. Returns a function that restores these states after the solver has repeated its
/// steps.
std::function<void()> ContinuousGroup::keep_members() {
  auto states = std::make_shared<std::vector<std::unique_ptr<SlaveState>>>();
  for (auto* member : members_) states->push_back(member->alone().save_state());
  return [this, states] {
    for (std::size_t i = 0; i < members_.size(); ++i) members_[i]->alone().restore_state(*(*states)[i]);
  };
}

void ContinuousGroup::repeat_steps() {
  if (system_->repeat_steps([this] { return keep_members(); })) return;
  const auto time_ns = std::llround(system_->time_s() * 1e9);
  const auto text = fmt::format(
      "the solver restarts at {} s: the derivatives of its continuous system depend on more than time, "
      "states and inputs, so its earlier steps cannot be repeated. Results from here differ from those of a "
      "run without interruption within the solver's tolerance; \"restart_at_points\": true in \"solver\" "
      "gives the same bits",
      system_->time_s());
  setup_.messages->message({members_.front()->name(), Severity::warning, "notice", text, time_ns});
}

}  // namespace mebots::master
