// SPDX-License-Identifier: Apache-2.0
#include "isolated_interfaces.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>

namespace mebots::master::isolation {
namespace {

DiscreteUpdate get_update(SharedReader& answers) {
  DiscreteUpdate update;
  update.needs_another = answers.get_flag();
  update.terminate = answers.get_flag();
  update.next_event_s = answers.get_optional();
  return update;
}

Evaluation get_evaluation(SharedReader& answers) {
  return answers.get_flag() ? Evaluation::recoverable : Evaluation::ok;
}

std::int64_t nanoseconds(double time_s) {
  return std::llround(time_s * 1e9);
}

}  // namespace

bool IsolatedClocks::ticks(ValueReference clock) {
  bool ticks = false;
  exchange(
      Call::ticks, [&](SharedReader& answers) { ticks = answers.get_flag(); }, clock);
  return ticks;
}

void IsolatedClocks::tick(ValueReference clock) {
  defer(Call::tick, clock);
}

std::optional<double> IsolatedClocks::new_interval(ValueReference clock) {
  std::optional<double> interval_s;
  exchange(
      Call::new_interval, [&](SharedReader& answers) { interval_s = answers.get_optional(); }, clock);
  return interval_s;
}

double IsolatedClocks::shift(ValueReference clock) {
  double shift_s = 0;
  exchange(
      Call::shift, [&](SharedReader& answers) { shift_s = answers.get<double>(); }, clock);
  return shift_s;
}

IsolatedModelExchange::IsolatedModelExchange(const ResolvedInstance& instance, MessageSink& messages,
                                             const std::atomic<bool>* interrupted, const TimeGrid& grid)
    : IsolatedClocks(instance, messages, interrupted, grid),
      continuous_(continuous_states_of(*instance.model, IsolatedClocks::name())) {}

template <typename... Arguments>
Evaluation IsolatedModelExchange::get_values(Call call, std::span<double> values, const Arguments&... arguments) {
  auto evaluation = Evaluation::ok;
  const auto take = [&](SharedReader& answers) {
    evaluation = get_evaluation(answers);
    answers.get(values);
  };
  exchange(call, take, arguments...);
  return evaluation;
}

template <typename... Arguments>
Evaluation IsolatedModelExchange::evaluate(Call call, const Arguments&... arguments) {
  auto evaluation = Evaluation::ok;
  exchange(
      call, [&](SharedReader& answers) { evaluation = get_evaluation(answers); }, arguments...);
  return evaluation;
}

void IsolatedModelExchange::set_time(double time_s) {
  set_time_ns(nanoseconds(time_s));
  defer(Call::set_time, time_s);
}

void IsolatedModelExchange::get_states(std::span<double> states) {
  get_values(Call::get_states, states);
}

Evaluation IsolatedModelExchange::set_states(std::span<const double> states) {
  return evaluate(Call::set_states, states);
}

Evaluation IsolatedModelExchange::get_derivatives(std::span<double> derivatives) {
  return get_values(Call::get_derivatives, derivatives);
}

Evaluation IsolatedModelExchange::get_indicators(std::span<double> indicators) {
  return get_values(Call::get_indicators, indicators);
}

void IsolatedModelExchange::get_nominals(std::span<double> nominals) {
  get_values(Call::get_nominals, nominals);
}

Evaluation IsolatedModelExchange::get_outputs(std::span<const ValueReference> references, std::span<double> values) {
  return get_values(Call::get_outputs, values, references);
}

Evaluation IsolatedModelExchange::set_inputs(std::span<const ValueReference> references,
                                             std::span<const double> values) {
  return evaluate(Call::set_inputs, references, values);
}

void IsolatedModelExchange::enter_event_mode() {
  defer(Call::enter_event_mode);
}

DiscreteUpdate IsolatedModelExchange::update_discrete_states() {
  DiscreteUpdate update;
  exchange(Call::update_discrete_states, [&](SharedReader& answers) { update = get_update(answers); });
  return update;
}

void IsolatedModelExchange::enter_continuous_time_mode() {
  defer(Call::enter_continuous_time_mode);
}

bool IsolatedModelExchange::needs_completed_step() const {
  return !description().model_exchange->completed_integrator_step_not_needed;
}

CompletedStep IsolatedModelExchange::completed_step() {
  CompletedStep step;
  exchange(Call::completed_step, [&](SharedReader& answers) {
    step.enter_event_mode = answers.get_flag();
    step.terminate = answers.get_flag();
  });
  return step;
}

void IsolatedModelExchange::directional_derivatives(std::span<const ValueReference> unknowns,
                                                    std::span<const ValueReference> knowns,
                                                    std::span<const double> seed, std::span<double> change) {
  get_values(Call::directional_derivatives, change, unknowns, knowns, seed);
}

std::optional<StepEnd> IsolatedEventSlave::step_until(double start_s, double end_s) {
  set_time_ns(nanoseconds(start_s));
  bool is_done = false;
  StepEnd end;
  const auto take = [&](SharedReader& answers) {
    is_done = answers.get_flag();
    end.event = answers.get_flag();
    end.terminate = answers.get_flag();
    end.time_s = answers.get<double>();
    if (!is_done || (end.time_s >= start_s && end.time_s <= end_s)) return;
    throw DamagedMemory(
        fmt::format("it claims to have reached {} s in a step from {} s to {} s", end.time_s, start_s, end_s));
  };
  exchange(Call::step_until, take, start_s, end_s);
  if (!is_done) return std::nullopt;
  set_time_ns(nanoseconds(end.time_s));
  return end;
}

void IsolatedEventSlave::enter_event_mode() {
  defer(Call::enter_event_mode);
}

void IsolatedEventSlave::enter_step_mode() {
  defer(Call::enter_step_mode);
}

DiscreteUpdate IsolatedEventSlave::update_discrete_states() {
  DiscreteUpdate update;
  exchange(Call::update_discrete_states, [&](SharedReader& answers) { update = get_update(answers); });
  return update;
}

}  // namespace mebots::master::isolation
