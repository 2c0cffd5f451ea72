// SPDX-License-Identifier: Apache-2.0
#include "engine/step_control/step_control.hpp"

#include "mebots/state/save.hpp"

#include <algorithm>

namespace mebots::master {

StepControl::StepControl(const ResolvedSystem& system, SlaveSteps& slaves, const OverrideSchedule* overrides)
    : description_(&*system.description->step_control),
      slaves_(&slaves),
      rolls_back_(system.step_control->rolls_back),
      controller_(*description_),
      measure_(system, slaves.ensemble()),
      forced_(system, slaves.ensemble(), overrides) {
  statistics_.worst.resize(system.step_control->measured.size());
}

std::optional<End> StepControl::step(Algorithm& algorithm, std::int64_t k, std::int64_t& reached) {
  if (!begun_) measure_.advance(point(k));
  begun_ = true;
  if (forced_.is_event(k)) controller_.restart();
  auto steps = controller_.next(forced_.after(k) - k);
  const auto saved = rolls_back_ ? std::optional(save()) : std::nullopt;
  const auto rejected_before = statistics_.rejected;
  CouplingMeasure::Error error;
  while (true) {
    if (auto end = algorithm.step({k, k + steps})) return end;
    error = measure_.error(point(k + steps));
    if (!saved || error.over_tolerance <= 1 || steps <= description_->min_steps) break;
    restore(*saved, k);
    ++statistics_.rejected;
    steps = std::max(steps / 2, description_->min_steps);
  }
  reached = k + steps;
  measure_.advance(point(reached));
  controller_.accept({.length = steps,
                      .error = error.over_tolerance,
                      .order = error.order,
                      .was_repeated = statistics_.rejected != rejected_before});
  count(steps, error);
  return std::nullopt;
}

void StepControl::count(std::int64_t steps, const CouplingMeasure::Error& error) {
  statistics_.add(steps, error.over_tolerance);
  if (error.worst) ++statistics_.worst[*error.worst];
}

StepControl::SavedPoint StepControl::save() const {
  auto& ensemble = slaves_->ensemble();
  SavedPoint saved;
  for (std::size_t i = 0; i < ensemble.size(); ++i) saved.slaves.push_back(ensemble.slave(i).save_state());
  saved.values = state::save(ensemble);
  return saved;
}

void StepControl::restore(const SavedPoint& saved, std::int64_t k) {
  auto& ensemble = slaves_->ensemble();
  for (std::size_t i = 0; i < ensemble.size(); ++i) ensemble.slave(i).restore_state(*saved.slaves[i]);
  state::restore(ensemble, saved.values);
  // Saved states contain neither addresses of OSMP buffers nor time derivatives of outputs, so outputs are read again.
  for (std::size_t i = 0; i < ensemble.size(); ++i) slaves_->read_outputs(i, k);
}

void StepControl::visit(state::Visitor& v) {
  v("begun", begun_);
  v("controller", controller_);
  v("measure", measure_);
  v("statistics", statistics_);
}

}  // namespace mebots::master
