// SPDX-License-Identifier: Apache-2.0
#include "slave/fmi/fmi3_slave.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace mebots::master {
namespace {

/// The maximum number of discrete updates in one event. An FMU that exceeds it fails, because its event does not end.
constexpr int kMostUpdates = 1000;
/// The maximum number of consecutive early returns without progress in time.
constexpr int kMostReturns = 1000;

}  // namespace

Fmi3Slave::Fmi3Slave(std::string name, std::shared_ptr<Fmu> fmu,
                     std::shared_ptr<const modeldesc::ModelDescription> model,
                     const modeldesc::StructuralValues& structural, std::vector<std::string> log_categories,
                     MessageSink& messages, const TimeGrid& grid, EventHandler handler)
    : Fmi3Instance(FmuKind::co_simulation, std::move(name), std::move(fmu), std::move(model), structural,
                   std::move(log_categories), messages, grid),
      handler_(handler),
      intermediate_inputs_(can_call_back() ? IntermediateInputs(description()) : IntermediateInputs()) {
  if (takes_input_derivatives()) calls().on_intermediate_update([this](double t_s) { set_intermediate_inputs(t_s); });
}

/// Exits initialization mode. An FMU that supports event mode is then in event mode.
void Fmi3Slave::exit_initialization() {
  Fmi3Instance::exit_initialization();
  if (handler_ == EventHandler::slave && uses_events() && handle_event()) {
    calls().fail("fmi3UpdateDiscreteStates", "ends the simulation at its start");
  }
}

/// Updates the discrete states until the event has ended. The FMU must be in event mode. Returns true if the FMU ends
/// the simulation. Otherwise, enters step mode and returns false.
bool Fmi3Slave::handle_event() {
  for (int updates = 0; updates < kMostUpdates; ++updates) {
    const auto update = update_event();
    if (update.terminate) return true;
    if (update.needs_another) continue;
    enter_step_mode();
    return false;
  }
  calls().fail("fmi3UpdateDiscreteStates",
               fmt::format("requested another update {} times in a row: the event does not end", kMostUpdates));
}

/// Calls fmi3DoStep. Returns nullopt if the FMU discards the step.
std::optional<StepEnd> Fmi3Slave::do_step(double start_s, double end_s, bool never_back) {
  StepEnd end;
  bool early = false;
  end.time_s = end_s;
  intermediate_inputs_.start_step(start_s);
  intermediate_status_ = InstanceCalls::kOk;
  const int status = calls().watched_step("fmi3DoStep", [&]() -> int {
    return calls().call("fmi3DoStep", functions().do_step, start_s, end_s - start_s, never_back, &end.event,
                        &end.terminate, &early, &end.time_s);
  });
  if (status == fmi3Discard) return std::nullopt;
  calls().check(status, "fmi3DoStep");
  calls().check(intermediate_status_, "fmi3SetFloat64 within a step");
  if (!early && !end.terminate) end.time_s = end_s;
  if (!(end.time_s >= start_s && end.time_s <= end_s)) {
    calls().fail("fmi3DoStep",
                 fmt::format("returned early at {} s, but the step was from {} s to {} s", end.time_s, start_s, end_s));
  }
  if (end.event && !uses_events()) {
    calls().fail("fmi3DoStep", "requests an event, but modelDescription.xml states hasEventMode = false");
  }
  return end;
}

std::optional<StepEnd> Fmi3Slave::step_until(double start_s, double end_s) {
  const auto start_ns = std::llround(start_s * 1e9);
  calls().set_time_ns(start_ns);
  const auto end = do_step(start_s, end_s, states().promise_at(start_ns));
  if (end) calls().set_time_ns(std::llround(end->time_s * 1e9));
  return end;
}

void Fmi3Slave::enter_event_mode() {
  calls().require("fmi3EnterEventMode", functions().enter_event_mode);
}

void Fmi3Slave::enter_step_mode() {
  calls().require("fmi3EnterStepMode", functions().enter_step_mode);
}

StepResult Fmi3Slave::terminated(double time_s) const {
  StepResult result;
  result.done = false;
  result.terminated = true;
  result.last_successful_s = time_s;
  result.messages = calls().last_messages();
  return result;
}

StepResult Fmi3Slave::step(std::int64_t start_ns, std::int64_t duration_ns) {
  calls().set_time_ns(start_ns);
  const auto end_ns = start_ns + duration_ns;
  const bool never_back = states().promise_at(start_ns);
  double time_s = calls().grid().time_s(start_ns);
  const double end_s = calls().grid().time_s(end_ns);
  int returns = 0;
  while (time_s < end_s) {
    const auto end = do_step(time_s, end_s, never_back);
    if (!end) {
      calls().deliver_held();
      StepResult result;
      result.done = false;
      result.messages = calls().last_messages();
      return result;
    }
    if (end->terminate) return terminated(end->time_s);
    returns = end->time_s > time_s ? 0 : returns + 1;
    if (returns == kMostReturns) {
      calls().fail("fmi3DoStep", fmt::format("returned early at {} s {} times in a row", time_s, kMostReturns));
    }
    time_s = end->time_s;
    if (!end->event) continue;
    enter_event_mode();
    if (handle_event()) return terminated(time_s);
  }
  calls().set_time_ns(end_ns);
  return {};
}

void Fmi3Slave::set_reals(std::span<const ValueReference> references, std::span<const double> values) {
  if (!intermediate_inputs_.empty()) intermediate_inputs_.set(references, values);
  Fmi3Instance::set_reals(references, values);
}

void Fmi3Slave::set_input_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                                      std::span<const double> values) {
  intermediate_inputs_.set_derivatives(references, orders, values);
}

/// Sets the inputs at a time within the step. Called by the FMU. Errors are reported after the step.
void Fmi3Slave::set_intermediate_inputs(double time_s) noexcept {
  try {
    const auto [references, values] = intermediate_inputs_.values_at(time_s);
    if (references.empty()) return;
    const int status = calls().call_inside(functions().set_float64, references.data(), references.size(), values.data(),
                                           values.size());
    intermediate_status_ = std::max(intermediate_status_, status);
  } catch (...) {
    intermediate_status_ = InstanceCalls::kError;
  }
}

std::uint32_t Fmi3Slave::output_derivative_order() const {
  return functions().get_output_derivatives == nullptr ? 0 : description().co_simulation->max_output_derivative_order;
}

void Fmi3Slave::get_output_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                                       std::span<double> values) {
  calls().require("fmi3GetOutputDerivatives", functions().get_output_derivatives, references.data(), references.size(),
                  orders.data(), values.data(), values.size());
}

}  // namespace mebots::master
