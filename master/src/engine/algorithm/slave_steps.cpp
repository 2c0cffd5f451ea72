// SPDX-License-Identifier: Apache-2.0
#include "engine/algorithm/slave_steps.hpp"

#include "base/signal_guard.hpp"
#include "base/time.hpp"
#include "mebots/assert.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace mebots::master {

End interrupted_at(std::int64_t time_ns) {
  return {EndReason::interrupted, fmt::format("interrupted at {} s", to_seconds(time_ns))};
}

SlaveSteps::SlaveSteps(const ResolvedSystem& system, Ensemble& ensemble, const std::atomic<bool>& interrupted)
    : system_(&system), ensemble_(&ensemble), interrupted_(&interrupted), grid_(system.description->grid()) {
  for (const auto& instance : system.instances)
    steps_.push_back({instance.description->steps, instance.description->divide_discarded});
  MEBOTS_ASSERT(steps_.size() == ensemble.size());
}

void SlaveSteps::write_inputs(std::size_t slave, std::int64_t k) {
  if (begins_step(slave, k)) ensemble_->write_inputs(slave, time_ns(k));
}

StepResult SlaveSteps::step(std::size_t slave, const GridStep& span) {
  stop_if_interrupted(*interrupted_);
  auto& target = ensemble_->slave(slave);
  const auto start_ns = time_ns(span.from);
  const auto& [multiple, is_divided] = steps_[slave];
  const auto duration_ns = time_ns(multiple == 1 ? span.to : span.from + multiple) - start_ns;
  if (is_divided) return step_in_parts(target, start_ns, duration_ns, *interrupted_);
  return target.step(start_ns, duration_ns);
}

StepResult SlaveSteps::finish(std::size_t slave, const GridStep& span, StepResult result) {
  if (result.pending) result = ensemble_->slave(slave).finish_step(*interrupted_);
  if (result.done || result.terminated || result.cancelled) return result;
  throw discarded(slave, span, result);
}

SlaveError SlaveSteps::discarded(std::size_t slave, const GridStep& span, const StepResult& result) const {
  const auto& model = *system_->instances[slave].model;
  const char* version = model.is_fmi1() ? "" : model.is_fmi3() ? "3" : "2";
  const bool can_divide = !steps_[slave].is_divided && model.co_simulation &&
                          model.co_simulation->can_get_and_set_fmu_state &&
                          model.co_simulation->can_handle_variable_communication_step_size;
  return SlaveError(
      fmt::format("instance '{}' at {} s: fmi{}DoStep discarded a step of {} s (fmi{}Discard) after reaching {} s. Use "
                  "a smaller step{}. {}",
                  ensemble_->name(slave), to_seconds(time_ns(span.from)), version,
                  time_text(system_->description->length_of(std::max(steps_[slave].multiple, span.to - span.from))),
                  version, result.last_successful_s.value_or(to_seconds(time_ns(span.from))),
                  can_divide ? ", or set \"on_discard\": \"divide\" for the instance" : "", result.messages));
}

void SlaveSteps::read_outputs(std::size_t slave, std::int64_t k) {
  if (begins_step(slave, k)) ensemble_->read_outputs(slave, time_ns(k));
}

std::optional<End> SlaveSteps::end_of(std::size_t slave, std::int64_t k, const StepResult& result) const {
  if (result.cancelled) return interrupted_at(time_ns(k));
  if (!result.terminated) return std::nullopt;
  return End{EndReason::terminated, fmt::format("instance '{}' ended the simulation at {} s", ensemble_->name(slave),
                                                result.last_successful_s.value_or(to_seconds(time_ns(k))))};
}

}  // namespace mebots::master
