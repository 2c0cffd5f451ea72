// SPDX-License-Identifier: Apache-2.0
#include "slave/fmi/fmi2_model_exchange.hpp"

#include "mebots/fmi2/types.hpp"

#include <cmath>
#include <utility>

namespace mebots::master {

Fmi2ModelExchange::Fmi2ModelExchange(std::string name, std::shared_ptr<Fmu> fmu,
                                     std::vector<std::string> log_categories, MessageSink& messages,
                                     const TimeGrid& grid)
    : Fmi2Slave(FmuKind::model_exchange, std::move(name), std::move(fmu), std::move(log_categories), messages, grid),
      continuous_(continuous_states_of(description(), this->name())) {}

StepResult Fmi2ModelExchange::step(std::int64_t /*start_ns*/, std::int64_t /*duration_ns*/) {
  fail_to_step(name());
}

/// Converts a status to an Evaluation. Discard is not an error, because the solver then tries a smaller step.
Evaluation Fmi2ModelExchange::evaluated(int status, const char* function) {
  if (status != fmi2Discard) {
    calls().check(status, function);
    return Evaluation::ok;
  }
  calls().deliver_held();
  return Evaluation::recoverable;
}

void Fmi2ModelExchange::set_time(double time_s) {
  calls().set_time_ns(std::llround(time_s * 1e9));
  calls().require("fmi2SetTime", functions().set_time, time_s);
}

void Fmi2ModelExchange::get_states(std::span<double> states) {
  calls().require("fmi2GetContinuousStates", functions().get_continuous_states, states.data(), states.size());
}

Evaluation Fmi2ModelExchange::set_states(std::span<const double> states) {
  constexpr const char* kFunction = "fmi2SetContinuousStates";
  return evaluated(calls().call(kFunction, functions().set_continuous_states, states.data(), states.size()), kFunction);
}

Evaluation Fmi2ModelExchange::get_derivatives(std::span<double> derivatives) {
  constexpr const char* kFunction = "fmi2GetDerivatives";
  return evaluated(calls().call(kFunction, functions().get_derivatives, derivatives.data(), derivatives.size()),
                   kFunction);
}

Evaluation Fmi2ModelExchange::get_indicators(std::span<double> indicators) {
  constexpr const char* kFunction = "fmi2GetEventIndicators";
  return evaluated(calls().call(kFunction, functions().get_event_indicators, indicators.data(), indicators.size()),
                   kFunction);
}

void Fmi2ModelExchange::get_nominals(std::span<double> nominals) {
  calls().require("fmi2GetNominalsOfContinuousStates", functions().get_nominals_of_continuous_states, nominals.data(),
                  nominals.size());
}

Evaluation Fmi2ModelExchange::get_outputs(std::span<const ValueReference> references, std::span<double> values) {
  constexpr const char* kFunction = "fmi2GetReal";
  return evaluated(calls().call(kFunction, functions().get_real, references.data(), references.size(), values.data()),
                   kFunction);
}

Evaluation Fmi2ModelExchange::set_inputs(std::span<const ValueReference> references, std::span<const double> values) {
  constexpr const char* kFunction = "fmi2SetReal";
  return evaluated(calls().call(kFunction, functions().set_real, references.data(), references.size(), values.data()),
                   kFunction);
}

void Fmi2ModelExchange::enter_event_mode() {
  calls().require("fmi2EnterEventMode", functions().enter_event_mode);
}

DiscreteUpdate Fmi2ModelExchange::update_discrete_states() {
  fmi2EventInfo info{};
  calls().require("fmi2NewDiscreteStates", functions().new_discrete_states, &info);
  DiscreteUpdate update;
  update.needs_another = info.newDiscreteStatesNeeded != fmi2False;
  update.terminate = info.terminateSimulation != fmi2False;
  if (info.nextEventTimeDefined != fmi2False) update.next_event_s = info.nextEventTime;
  return update;
}

void Fmi2ModelExchange::enter_continuous_time_mode() {
  calls().require("fmi2EnterContinuousTimeMode", functions().enter_continuous_time_mode);
}

bool Fmi2ModelExchange::needs_completed_step() const {
  return !description().model_exchange->completed_integrator_step_not_needed;
}

CompletedStep Fmi2ModelExchange::completed_step() {
  const bool never_back = states().promise_at(calls().time_ns());
  fmi2Boolean enter_event_mode = fmi2False;
  fmi2Boolean terminate = fmi2False;
  calls().require("fmi2CompletedIntegratorStep", functions().completed_integrator_step,
                  never_back ? fmi2True : fmi2False, &enter_event_mode, &terminate);
  return {.enter_event_mode = enter_event_mode != fmi2False, .terminate = terminate != fmi2False};
}

bool Fmi2ModelExchange::has_directional_derivatives() const {
  return description().model_exchange->provides_directional_derivative &&
         functions().get_directional_derivative != nullptr;
}

void Fmi2ModelExchange::directional_derivatives(std::span<const ValueReference> unknowns,
                                                std::span<const ValueReference> knowns, std::span<const double> seed,
                                                std::span<double> change) {
  calls().require("fmi2GetDirectionalDerivative", functions().get_directional_derivative, unknowns.data(),
                  unknowns.size(), knowns.data(), knowns.size(), seed.data(), change.data());
}

}  // namespace mebots::master
