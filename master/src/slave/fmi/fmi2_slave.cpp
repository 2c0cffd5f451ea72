// SPDX-License-Identifier: Apache-2.0
#include "slave/fmi/fmi2_slave.hpp"

#include "mebots/assert.hpp"
#include "mebots/fmi2/types.hpp"

#include "fmi/call/callbacks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <type_traits>
#include <utility>

namespace mebots::master {
namespace {

static_assert(std::is_same_v<fmi2Integer, std::int32_t>);
static_assert(std::is_same_v<fmi2Boolean, std::int32_t>);
static_assert(std::is_same_v<fmi2ValueReference, ValueReference>);
static_assert(InstanceCalls::kOk == fmi2OK && InstanceCalls::kWarning == fmi2Warning &&
              InstanceCalls::kDiscard == fmi2Discard && InstanceCalls::kError == fmi2Error &&
              InstanceCalls::kFatal == fmi2Fatal && InstanceCalls::kPending == fmi2Pending);

std::string_view fmi2_status_name(int status) {
  return fmi2::status_name(static_cast<fmi2Status>(status));
}

bool runs_asynchronously(const modeldesc::ModelDescription& description, FmuKind kind) {
  return kind == FmuKind::co_simulation && description.co_simulation->can_run_asynchronuously;
}

}  // namespace

Fmi2Slave::Fmi2Slave(FmuKind kind, std::string name, std::shared_ptr<Fmu> fmu, std::vector<std::string> log_categories,
                     MessageSink& messages, const TimeGrid& grid)
    : functions_(&fmu->functions<Fmi2Functions>()),
      calls_(std::move(name), std::move(fmu), std::move(log_categories), messages, grid, fmi2_status_name),
      steps_(calls_, pending_, *functions_, runs_asynchronously(calls_.description(), kind)),
      states_(calls_, *functions_, kFmi2StateNames,
              implementation_of(calls_.description(), kind)->can_get_and_set_fmu_state,
              implementation_of(calls_.description(), kind)->can_serialize_fmu_state) {
  const bool is_stepped = kind == FmuKind::co_simulation;
  const auto& callbacks = calls_.target().functions(runs_asynchronously(description(), kind));
  calls_.on_step_finished([this](int status) { pending_.finished(status); });
  // Enables logging, because many FMUs otherwise log nothing if this call fails.
  calls_.instantiate("fmi2Instantiate", [&] {
    return functions_->instantiate(this->name().c_str(), is_stepped ? fmi2CoSimulation : fmi2ModelExchange,
                                   description().guid.c_str(), calls_.fmu().resource_uri().c_str(), &callbacks,
                                   fmi2False, fmi2True);
  });
  const auto categories = calls_.chosen_categories();
  if (functions_->set_debug_logging == nullptr || categories.empty()) return;
  calls_.require("fmi2SetDebugLogging", functions_->set_debug_logging, fmi2True, categories.size(), categories.data());
}

Fmi2Slave::~Fmi2Slave() {
  InstanceCalls::without_exceptions([this] { Fmi2Slave::free_instance(); });
}

std::optional<std::string> Fmi2Slave::free_instance() {
  return calls_.free_instance("fmi2FreeInstance", [&] {
    steps_.end();
    if (calls_.usable()) calls_.call("fmi2FreeInstance", functions_->free_instance);
  });
}

void Fmi2Slave::setup_experiment(const Experiment& experiment) {
  calls_.set_time_ns(experiment.start_ns);
  const auto& stop_ns = experiment.stop_ns;
  const auto& tolerance = experiment.tolerance;
  calls_.watched("fmi2SetupExperiment", [&] {
    calls_.require("fmi2SetupExperiment", functions_->setup_experiment, tolerance ? fmi2True : fmi2False,
                   tolerance.value_or(0), to_seconds(experiment.start_ns), stop_ns ? fmi2True : fmi2False,
                   calls_.grid().time_s(stop_ns.value_or(0)));
  });
}

void Fmi2Slave::enter_initialization() {
  calls_.watched("fmi2EnterInitializationMode",
                 [&] { calls_.require("fmi2EnterInitializationMode", functions_->enter_initialization_mode); });
}

void Fmi2Slave::exit_initialization() {
  calls_.watched("fmi2ExitInitializationMode",
                 [&] { calls_.require("fmi2ExitInitializationMode", functions_->exit_initialization_mode); });
}

StepResult Fmi2Slave::step(std::int64_t start_ns, std::int64_t duration_ns) {
  return steps_.step(start_ns, duration_ns, states_.promise_at(start_ns) ? fmi2True : fmi2False);
}

void Fmi2Slave::terminate() {
  if (!calls_.usable()) return;  // a step could not be cancelled
  calls_.watched("fmi2Terminate", [&] { calls_.require("fmi2Terminate", functions_->terminate); });
}

std::uint32_t Fmi2Slave::output_derivative_order() const {
  return functions_->get_real_output_derivatives == nullptr ? 0
                                                            : description().co_simulation->max_output_derivative_order;
}

bool Fmi2Slave::takes_input_derivatives() const {
  return description().co_simulation->can_interpolate_inputs && functions_->set_real_input_derivatives != nullptr;
}

void Fmi2Slave::get_output_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                                       std::span<double> values) {
  calls_.require("fmi2GetRealOutputDerivatives", functions_->get_real_output_derivatives, references.data(),
                 references.size(), orders.data(), values.data());
}

void Fmi2Slave::set_input_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                                      std::span<const double> values) {
  calls_.require("fmi2SetRealInputDerivatives", functions_->set_real_input_derivatives, references.data(),
                 references.size(), orders.data(), values.data());
}

void Fmi2Slave::get_reals(std::span<const ValueReference> references, std::span<double> values) {
  calls_.require("fmi2GetReal", functions_->get_real, references.data(), references.size(), values.data());
}

void Fmi2Slave::get_integers(std::span<const ValueReference> references, std::span<std::int64_t> values) {
  numbers_.resize(references.size());
  calls_.require("fmi2GetInteger", functions_->get_integer, references.data(), references.size(), numbers_.data());
  std::ranges::copy(numbers_, values.begin());
}

void Fmi2Slave::get_booleans(std::span<const ValueReference> references, std::span<std::int64_t> values) {
  numbers_.resize(references.size());
  calls_.require("fmi2GetBoolean", functions_->get_boolean, references.data(), references.size(), numbers_.data());
  std::ranges::transform(numbers_, values.begin(), [](fmi2Boolean value) { return value == fmi2False ? 0 : 1; });
}

void Fmi2Slave::get_strings(std::span<const ValueReference> references, std::span<std::string> values) {
  texts_.assign(references.size(), nullptr);
  calls_.require("fmi2GetString", functions_->get_string, references.data(), references.size(), texts_.data());
  calls_.copy_texts("fmi2GetString", references, texts_, values);
}

void Fmi2Slave::set_reals(std::span<const ValueReference> references, std::span<const double> values) {
  calls_.require("fmi2SetReal", functions_->set_real, references.data(), references.size(), values.data());
}

/// Converts values to 32 bits. The values fit, because `resolve` and Ensemble check their range.
std::span<const std::int32_t> Fmi2Slave::narrowed(std::span<const std::int64_t> values) {
  numbers_.resize(values.size());
  std::ranges::transform(values, numbers_.begin(), [](std::int64_t value) { return static_cast<std::int32_t>(value); });
  return numbers_;
}

void Fmi2Slave::set_integers(std::span<const ValueReference> references, std::span<const std::int64_t> values) {
  calls_.require("fmi2SetInteger", functions_->set_integer, references.data(), references.size(),
                 narrowed(values).data());
}

void Fmi2Slave::set_booleans(std::span<const ValueReference> references, std::span<const std::int64_t> values) {
  calls_.require("fmi2SetBoolean", functions_->set_boolean, references.data(), references.size(),
                 narrowed(values).data());
}

void Fmi2Slave::set_strings(std::span<const ValueReference> references, std::span<const std::string> values) {
  texts_.clear();
  for (const auto& value : values) texts_.push_back(value.c_str());
  calls_.require("fmi2SetString", functions_->set_string, references.data(), references.size(), texts_.data());
}

}  // namespace mebots::master
