// SPDX-License-Identifier: Apache-2.0
#include "slave/fmi/fmi3_slave.hpp"

#include "mebots/assert.hpp"

#include "fmi/call/fmi2_callbacks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace mebots::master {
namespace {

static_assert(InstanceCalls::kOk == fmi3OK && InstanceCalls::kWarning == fmi3Warning &&
              InstanceCalls::kDiscard == fmi3Discard && InstanceCalls::kError == fmi3Error &&
              InstanceCalls::kFatal == fmi3Fatal);

/// An event that asks for more updates of the discrete states than this does not settle.
constexpr int kMostUpdates = 1000;
/// Early returns in a row without progress in time.
constexpr int kMostReturns = 1000;

std::string_view fmi3_status_name(int status) {
  return fmi3::status_name(static_cast<fmi3Status>(status));
}

}  // namespace

Fmi3Slave::Fmi3Slave(std::string name, std::shared_ptr<Fmu> fmu,
                     std::shared_ptr<const modeldesc::ModelDescription> model,
                     const modeldesc::StructuralValues& structural, std::vector<std::string> log_categories,
                     MessageSink& messages, const TimeGrid& grid)
    : functions_(&fmu->fmi3_functions()),
      model_(std::move(model)),
      uses_events_(model_->co_simulation->has_event_mode),
      calls_(std::move(name), std::move(fmu), std::move(log_categories), messages, grid, fmi3_status_name),
      values_(calls_, *functions_, *model_),
      states_(calls_, *functions_, kFmi3StateNames, model_->co_simulation->can_get_and_set_fmu_state,
              model_->co_simulation->can_serialize_fmu_state) {
  const auto path = calls_.fmu().resource_path();
  const auto callbacks = calls_.target().fmi3_callbacks();
  // Logging is on from the start: many FMUs say nothing about a failing instantiation otherwise.
  calls_.instantiate("fmi3InstantiateCoSimulation", [&] {
    return functions_->instantiate_co_simulation(
        this->name().c_str(), description().guid.c_str(), path.empty() ? nullptr : path.c_str(), false, true,
        uses_events_, uses_events_, nullptr, 0, callbacks.environment, callbacks.log_message, nullptr);
  });
  const auto categories = calls_.chosen_categories();
  if (functions_->set_debug_logging != nullptr && !categories.empty()) {
    calls_.require("fmi3SetDebugLogging", functions_->set_debug_logging, true, categories.size(), categories.data());
  }
  configure(structural);
}

Fmi3Slave::~Fmi3Slave() {
  Fmi3Slave::free_instance();
}

std::optional<std::string> Fmi3Slave::free_instance() {
  return calls_.free_instance("fmi3FreeInstance", [&] { calls_.call("fmi3FreeInstance", functions_->free_instance); });
}

void Fmi3Slave::configure(const modeldesc::StructuralValues& structural) {
  if (structural.empty()) return;
  if (functions_->enter_configuration_mode == nullptr || functions_->exit_configuration_mode == nullptr) {
    calls_.fail("fmi3EnterConfigurationMode", "is missing in the FMU's library");
  }
  calls_.require("fmi3EnterConfigurationMode", functions_->enter_configuration_mode);
  for (const auto& [reference, value] : structural) {
    calls_.require("fmi3SetUInt64", functions_->set_uint64, &reference, std::size_t{1}, &value, std::size_t{1});
  }
  calls_.require("fmi3ExitConfigurationMode", functions_->exit_configuration_mode);
}

void Fmi3Slave::enter_initialization() {
  const auto& [start_ns, stop_ns, tolerance] = experiment_;
  calls_.set_time_ns(start_ns);
  calls_.watched("fmi3EnterInitializationMode", [&] {
    calls_.require("fmi3EnterInitializationMode", functions_->enter_initialization_mode, tolerance.has_value(),
                   tolerance.value_or(0), calls_.grid().time_s(start_ns), stop_ns.has_value(),
                   calls_.grid().time_s(stop_ns.value_or(0)));
  });
}

/// Initialisation ends in event mode if the FMU has one.
void Fmi3Slave::exit_initialization() {
  calls_.watched("fmi3ExitInitializationMode",
                 [&] { calls_.require("fmi3ExitInitializationMode", functions_->exit_initialization_mode); });
  if (uses_events_ && handle_event()) {
    calls_.fail("fmi3UpdateDiscreteStates", "ends the simulation at its start");
  }
}

/// In event mode. Returns true if the FMU ends the simulation; else it is in step mode afterwards.
bool Fmi3Slave::handle_event() {
  for (int updates = 0; updates < kMostUpdates; ++updates) {
    fmi3Boolean need_update = false;
    fmi3Boolean terminate = false;
    fmi3Boolean nominals_changed = false;
    fmi3Boolean states_changed = false;
    fmi3Boolean next_event_defined = false;
    fmi3Float64 next_event_s = 0;
    calls_.require("fmi3UpdateDiscreteStates", functions_->update_discrete_states, &need_update, &terminate,
                   &nominals_changed, &states_changed, &next_event_defined, &next_event_s);
    if (terminate) return true;
    if (need_update) continue;
    calls_.require("fmi3EnterStepMode", functions_->enter_step_mode);
    return false;
  }
  calls_.fail("fmi3UpdateDiscreteStates",
              fmt::format("asked for another update {} times in a row: the event does not settle", kMostUpdates));
}

/// Nothing for fmi3Discard.
std::optional<Fmi3Slave::Outcome> Fmi3Slave::do_step(double start_s, double end_s, bool never_back) {
  Outcome outcome;
  outcome.time_s = end_s;
  const int status = calls_.watched_step("fmi3DoStep", [&]() -> int {
    return calls_.call("fmi3DoStep", functions_->do_step, start_s, end_s - start_s, never_back, &outcome.event,
                       &outcome.terminate, &outcome.early, &outcome.time_s);
  });
  if (status == fmi3Discard) return std::nullopt;
  calls_.check(status, "fmi3DoStep");
  if (!outcome.early && !outcome.terminate) outcome.time_s = end_s;
  if (!(outcome.time_s >= start_s && outcome.time_s <= end_s)) {
    calls_.fail("fmi3DoStep", fmt::format("returned early at {} s, but the step was from {} s to {} s", outcome.time_s,
                                          start_s, end_s));
  }
  if (outcome.event && !uses_events_) {
    calls_.fail("fmi3DoStep", "asks for an event, but modelDescription.xml states hasEventMode = false");
  }
  return outcome;
}

StepResult Fmi3Slave::terminated(double time_s) const {
  StepResult result;
  result.done = false;
  result.terminated = true;
  result.last_successful_s = time_s;
  result.messages = calls_.last_messages();
  return result;
}

StepResult Fmi3Slave::step(std::int64_t start_ns, std::int64_t duration_ns) {
  calls_.set_time_ns(start_ns);
  const auto end_ns = start_ns + duration_ns;
  const bool never_back = states_.promise_at(start_ns);
  double time_s = calls_.grid().time_s(start_ns);
  const double end_s = calls_.grid().time_s(end_ns);
  int returns = 0;
  while (time_s < end_s) {
    const auto outcome = do_step(time_s, end_s, never_back);
    if (!outcome) {
      calls_.deliver_held();
      StepResult result;
      result.done = false;
      result.messages = calls_.last_messages();
      return result;
    }
    if (outcome->terminate) return terminated(outcome->time_s);
    returns = outcome->time_s > time_s ? 0 : returns + 1;
    if (returns == kMostReturns) {
      calls_.fail("fmi3DoStep", fmt::format("returned early at {} s {} times in a row", time_s, kMostReturns));
    }
    time_s = outcome->time_s;
    if (!outcome->event) continue;
    calls_.require("fmi3EnterEventMode", functions_->enter_event_mode);
    if (handle_event()) return terminated(time_s);
  }
  calls_.set_time_ns(end_ns);
  return {};
}

void Fmi3Slave::terminate() {
  calls_.watched("fmi3Terminate", [&] { calls_.require("fmi3Terminate", functions_->terminate); });
}

std::uint32_t Fmi3Slave::output_derivative_order() const {
  return functions_->get_output_derivatives == nullptr ? 0 : model_->co_simulation->max_output_derivative_order;
}

void Fmi3Slave::get_output_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                                       std::span<double> values) {
  calls_.require("fmi3GetOutputDerivatives", functions_->get_output_derivatives, references.data(), references.size(),
                 orders.data(), values.data(), values.size());
}

}  // namespace mebots::master
