// SPDX-License-Identifier: Apache-2.0
#include "slave/fmi/fmi3_model_exchange.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace mebots::master {

Fmi3ModelExchange::Fmi3ModelExchange(std::string name, std::shared_ptr<Fmu> fmu,
                                     std::shared_ptr<const modeldesc::ModelDescription> model,
                                     const modeldesc::StructuralValues& structural,
                                     std::vector<std::string> log_categories, MessageSink& messages,
                                     const TimeGrid& grid)
    : Fmi3Instance(FmuKind::model_exchange, std::move(name), std::move(fmu), std::move(model), structural,
                   std::move(log_categories), messages, grid),
      continuous_(continuous_states_of(description(), this->name())) {}

void Fmi3ModelExchange::exit_initialization() {
  Fmi3Instance::exit_initialization();
  std::size_t states = 0;
  calls().require("fmi3GetNumberOfContinuousStates", functions().get_number_of_continuous_states, &states);
  check_count("fmi3GetNumberOfContinuousStates", states, state_count(), "continuous states");
  std::size_t indicators = 0;
  calls().require("fmi3GetNumberOfEventIndicators", functions().get_number_of_event_indicators, &indicators);
  check_count("fmi3GetNumberOfEventIndicators", indicators, indicator_count(), "event indicators");
}

void Fmi3ModelExchange::check_count(const char* function, std::size_t in_library, std::size_t described,
                                    std::string_view what) {
  if (in_library == described) return;
  calls().fail(function, fmt::format("returned {} {}, but modelDescription.xml has {}", in_library, what, described));
}

StepResult Fmi3ModelExchange::step(std::int64_t /*start_ns*/, std::int64_t /*duration_ns*/) {
  fail_to_step(name());
}

/// Converts a status to an Evaluation. Discard is not an error, because the solver then tries a smaller step.
Evaluation Fmi3ModelExchange::evaluated(int status, const char* function) {
  if (status != fmi3Discard) {
    calls().check(status, function);
    return Evaluation::ok;
  }
  calls().deliver_held();
  return Evaluation::recoverable;
}

void Fmi3ModelExchange::set_time(double time_s) {
  calls().set_time_ns(std::llround(time_s * 1e9));
  calls().require("fmi3SetTime", functions().set_time, time_s);
}

void Fmi3ModelExchange::get_states(std::span<double> states) {
  calls().require("fmi3GetContinuousStates", functions().get_continuous_states, states.data(), states.size());
}

Evaluation Fmi3ModelExchange::set_states(std::span<const double> states) {
  constexpr const char* kFunction = "fmi3SetContinuousStates";
  return evaluated(calls().call(kFunction, functions().set_continuous_states, states.data(), states.size()), kFunction);
}

Evaluation Fmi3ModelExchange::get_derivatives(std::span<double> derivatives) {
  constexpr const char* kFunction = "fmi3GetContinuousStateDerivatives";
  return evaluated(
      calls().call(kFunction, functions().get_continuous_state_derivatives, derivatives.data(), derivatives.size()),
      kFunction);
}

Evaluation Fmi3ModelExchange::get_indicators(std::span<double> indicators) {
  constexpr const char* kFunction = "fmi3GetEventIndicators";
  return evaluated(calls().call(kFunction, functions().get_event_indicators, indicators.data(), indicators.size()),
                   kFunction);
}

void Fmi3ModelExchange::get_nominals(std::span<double> nominals) {
  calls().require("fmi3GetNominalsOfContinuousStates", functions().get_nominals_of_continuous_states, nominals.data(),
                  nominals.size());
}

Evaluation Fmi3ModelExchange::get_outputs(std::span<const ValueReference> references, std::span<double> values) {
  return this->values().try_get(references, values) ? Evaluation::ok : Evaluation::recoverable;
}

Evaluation Fmi3ModelExchange::set_inputs(std::span<const ValueReference> references, std::span<const double> values) {
  return this->values().try_set(references, values) ? Evaluation::ok : Evaluation::recoverable;
}

void Fmi3ModelExchange::enter_event_mode() {
  calls().require("fmi3EnterEventMode", functions().enter_event_mode);
}

void Fmi3ModelExchange::enter_continuous_time_mode() {
  calls().require("fmi3EnterContinuousTimeMode", functions().enter_continuous_time_mode);
}

bool Fmi3ModelExchange::needs_completed_step() const {
  return !description().model_exchange->completed_integrator_step_not_needed;
}

CompletedStep Fmi3ModelExchange::completed_step() {
  const bool never_back = states().promise_at(calls().time_ns());
  CompletedStep result;
  calls().require("fmi3CompletedIntegratorStep", functions().completed_integrator_step, never_back,
                  &result.enter_event_mode, &result.terminate);
  return result;
}

bool Fmi3ModelExchange::has_directional_derivatives() const {
  return description().model_exchange->provides_directional_derivative &&
         functions().get_directional_derivative != nullptr;
}

/// Computes directional derivatives. fmi3GetDirectionalDerivative requires whole arrays. Elements that are not in
/// `knowns` have the seed 0.
void Fmi3ModelExchange::directional_derivatives(std::span<const ValueReference> unknowns,
                                                std::span<const ValueReference> knowns, std::span<const double> seed,
                                                std::span<double> change) {
  const auto to = values().whole(unknowns);
  const auto from = values().whole(knowns);
  std::vector<double> seeds(from.value_count, 0.0);
  for (std::size_t i = 0; i < knowns.size(); ++i) seeds[from.places[i]] = seed[i];
  std::vector<double> changes(to.value_count, 0.0);
  calls().require("fmi3GetDirectionalDerivative", functions().get_directional_derivative, to.references.data(),
                  to.references.size(), from.references.data(), from.references.size(), seeds.data(), seeds.size(),
                  changes.data(), changes.size());
  for (std::size_t i = 0; i < unknowns.size(); ++i) change[i] = changes[to.places[i]];
}

}  // namespace mebots::master
