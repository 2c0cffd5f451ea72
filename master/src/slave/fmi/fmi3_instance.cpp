// SPDX-License-Identifier: Apache-2.0
#include "slave/fmi/fmi3_instance.hpp"

#include "fmi/call/callbacks.hpp"
#include "slave/fmi/intermediate_inputs.hpp"

#include <utility>

namespace mebots::master {
namespace {

static_assert(InstanceCalls::kOk == fmi3OK && InstanceCalls::kWarning == fmi3Warning &&
              InstanceCalls::kDiscard == fmi3Discard && InstanceCalls::kError == fmi3Error &&
              InstanceCalls::kFatal == fmi3Fatal);

std::string_view fmi3_status_name(int status) {
  return fmi3::status_name(static_cast<fmi3Status>(status));
}

const modeldesc::Implementation& implementation(const modeldesc::ModelDescription& model, FmuKind kind) {
  if (kind == FmuKind::model_exchange) return *model.model_exchange;
  return *model.co_simulation;
}

}  // namespace

Fmi3Instance::Fmi3Instance(FmuKind kind, std::string name, std::shared_ptr<Fmu> fmu,
                           std::shared_ptr<const modeldesc::ModelDescription> model,
                           const modeldesc::StructuralValues& structural, std::vector<std::string> log_categories,
                           MessageSink& messages, const TimeGrid& grid)
    : functions_(&fmu->functions<Fmi3Functions>()),
      model_(std::move(model)),
      calls_(std::move(name), std::move(fmu), std::move(log_categories), messages, grid, fmi3_status_name),
      values_(calls_, *functions_, *model_),
      states_(calls_, *functions_, kFmi3StateNames, implementation(*model_, kind).can_get_and_set_fmu_state,
              implementation(*model_, kind).can_serialize_fmu_state) {
  const auto path = calls_.fmu().resource_path();
  calls_.instantiate(kind == FmuKind::model_exchange ? "fmi3InstantiateModelExchange" : "fmi3InstantiateCoSimulation",
                     [&] { return instantiate(kind, path.empty() ? nullptr : path.c_str()); });
  choose_log_categories();
  configure(structural);
}

/// Enables the chosen log categories. Ignores the status Discard of FMUs that have no selectable categories.
void Fmi3Instance::choose_log_categories() {
  const auto categories = calls_.chosen_categories();
  if (functions_->set_debug_logging == nullptr || categories.empty()) return;
  constexpr const char* kFunction = "fmi3SetDebugLogging";
  const int status = calls_.call(kFunction, functions_->set_debug_logging, true, categories.size(), categories.data());
  if (status == fmi3Discard) return calls_.deliver_held();
  calls_.check(status, kFunction);
}

/// Creates the instance. Enables logging, because many FMUs otherwise log nothing if this call fails.
void* Fmi3Instance::instantiate(FmuKind kind, const char* resources) {
  const auto callbacks = calls_.target().fmi3_callbacks();
  const char* const token = model_->guid.c_str();
  if (kind == FmuKind::model_exchange) {
    return functions_->instantiate_model_exchange(name().c_str(), token, resources, false, true, callbacks.environment,
                                                  callbacks.log_message);
  }
  const bool uses_events = model_->co_simulation->has_event_mode;
  const auto inputs = can_call_back() ? IntermediateInputs(*model_).references() : std::vector<std::uint32_t>();
  return functions_->instantiate_co_simulation(name().c_str(), token, resources, false, true, uses_events, uses_events,
                                               inputs.empty() ? nullptr : inputs.data(), inputs.size(),
                                               callbacks.environment, callbacks.log_message,
                                               inputs.empty() ? nullptr : callbacks.intermediate_update);
}

Fmi3Instance::~Fmi3Instance() {
  InstanceCalls::without_exceptions([this] { Fmi3Instance::free_instance(); });
}

std::optional<std::string> Fmi3Instance::free_instance() {
  return calls_.free_instance("fmi3FreeInstance", [&] { calls_.call("fmi3FreeInstance", functions_->free_instance); });
}

void Fmi3Instance::configure(const modeldesc::StructuralValues& structural) {
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

void Fmi3Instance::enter_initialization() {
  const auto& stop_ns = experiment_.stop_ns;
  const auto& tolerance = experiment_.tolerance;
  calls_.set_time_ns(experiment_.start_ns);
  calls_.watched("fmi3EnterInitializationMode", [&] {
    calls_.require("fmi3EnterInitializationMode", functions_->enter_initialization_mode, tolerance.has_value(),
                   tolerance.value_or(0), calls_.grid().time_s(experiment_.start_ns), stop_ns.has_value(),
                   calls_.grid().time_s(stop_ns.value_or(0)));
  });
}

void Fmi3Instance::exit_initialization() {
  calls_.watched("fmi3ExitInitializationMode",
                 [&] { calls_.require("fmi3ExitInitializationMode", functions_->exit_initialization_mode); });
}

DiscreteUpdate Fmi3Instance::update_event() {
  DiscreteUpdate update;
  fmi3Boolean nominals_changed = false;
  fmi3Boolean states_changed = false;
  fmi3Boolean next_event_defined = false;
  fmi3Float64 next_event_s = 0;
  calls_.require("fmi3UpdateDiscreteStates", functions_->update_discrete_states, &update.needs_another,
                 &update.terminate, &nominals_changed, &states_changed, &next_event_defined, &next_event_s);
  if (next_event_defined) update.next_event_s = next_event_s;
  return update;
}

bool Fmi3Instance::ticks(ValueReference clock) {
  calls_.require_function("fmi3GetClock", functions_->get_clock);
  fmi3Clock active = false;
  calls_.require("fmi3GetClock", functions_->get_clock, &clock, std::size_t{1}, &active);
  return active;
}

void Fmi3Instance::tick(ValueReference clock) {
  calls_.require_function("fmi3SetClock", functions_->set_clock);
  const fmi3Clock active = true;
  calls_.require("fmi3SetClock", functions_->set_clock, &clock, std::size_t{1}, &active);
}

std::optional<double> Fmi3Instance::new_interval(ValueReference clock) {
  calls_.require_function("fmi3GetIntervalDecimal", functions_->get_interval_decimal);
  double interval_s = 0;
  auto qualifier = fmi3IntervalNotYetKnown;
  calls_.require("fmi3GetIntervalDecimal", functions_->get_interval_decimal, &clock, std::size_t{1}, &interval_s,
                 &qualifier);
  return qualifier == fmi3IntervalChanged ? std::optional(interval_s) : std::nullopt;
}

double Fmi3Instance::shift(ValueReference clock) {
  calls_.require_function("fmi3GetShiftDecimal", functions_->get_shift_decimal);
  double shift_s = 0;
  calls_.require("fmi3GetShiftDecimal", functions_->get_shift_decimal, &clock, std::size_t{1}, &shift_s);
  return shift_s;
}

void Fmi3Instance::terminate() {
  calls_.watched("fmi3Terminate", [&] { calls_.require("fmi3Terminate", functions_->terminate); });
}

}  // namespace mebots::master
