// SPDX-License-Identifier: Apache-2.0
#include "slave/fmi/fmi1_slave.hpp"

#include "base/time.hpp"
#include "fmi/call/callbacks.hpp"
#include "model/fmu_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <type_traits>
#include <utility>

namespace mebots::master {
namespace {

static_assert(std::is_same_v<fmiInteger, std::int32_t>);
static_assert(std::is_same_v<fmiValueReference, ValueReference>);
static_assert(InstanceCalls::kOk == fmiOK && InstanceCalls::kWarning == fmiWarning &&
              InstanceCalls::kDiscard == fmiDiscard && InstanceCalls::kError == fmiError &&
              InstanceCalls::kFatal == fmiFatal && InstanceCalls::kPending == fmiPending);

/// MIME type of FMI 1.0 for FMUs whose library runs in this process, not in another tool.
constexpr const char* kMimeType = "application/x-fmu-sharedlibrary";
constexpr double kNoTimeout_ms = 0;

}  // namespace

Fmi1Slave::Fmi1Slave(std::string name, std::shared_ptr<Fmu> fmu, std::vector<std::string> log_categories,
                     MessageSink& messages, const TimeGrid& grid)
    : functions_(&fmu->functions<Fmi1Functions>()),
      callbacks_(CallbackTarget::fmi1_functions(fmu->description().co_simulation->can_run_asynchronuously)),
      negated_(fmu->description()),
      calls_(std::move(name), std::move(fmu), std::move(log_categories), messages, grid, fmi1::status_name),
      steps_(calls_, pending_, *functions_, callbacks_.stepFinished != nullptr) {
  calls_.on_step_finished([this](int status) { pending_.finished(status); });
  calls_.instantiate("fmiInstantiateSlave", [this] { return instantiate(); });
}

/// Creates an instance. Enables logging, because many FMUs otherwise log nothing if this call fails.
void* Fmi1Slave::instantiate() {
  return functions_->instantiate_slave(name().c_str(), description().guid.c_str(), calls_.fmu().location_uri().c_str(),
                                       kMimeType, kNoTimeout_ms, fmiFalse, fmiFalse, callbacks_, fmiTrue);
}

Fmi1Slave::~Fmi1Slave() {
  InstanceCalls::without_exceptions([this] { Fmi1Slave::free_instance(); });
}

std::optional<std::string> Fmi1Slave::free_instance() {
  return calls_.free_instance("fmiFreeSlaveInstance", [&] {
    steps_.end();
    if (calls_.usable()) calls_.call("fmiFreeSlaveInstance", functions_->free_slave_instance);
  });
}

void Fmi1Slave::setup_experiment(const Experiment& experiment) {
  calls_.set_time_ns(experiment.start_ns);
  experiment_ = experiment;
}

void Fmi1Slave::initialize() {
  const auto& stop_ns = experiment_.stop_ns;
  calls_.watched("fmiInitializeSlave", [&] {
    calls_.require("fmiInitializeSlave", functions_->initialize_slave, to_seconds(experiment_.start_ns),
                   stop_ns ? fmiTrue : fmiFalse, calls_.grid().time_s(stop_ns.value_or(0)));
  });
}

void Fmi1Slave::enter_initialization() {
  initialize();
  phase_ = Phase::initializing;
}

void Fmi1Slave::exit_initialization() {
  initialize_anew();
  phase_ = Phase::running;
  start_ = {};
}

/// Creates and initializes the instance again if it was not initialized with all values that are set. Does not use
/// fmiResetSlave, because some FMUs lose their variables in this function (tutorial-fmus of
/// open-simulation-platform/demo-cases).
void Fmi1Slave::initialize_anew() {
  if (!std::exchange(is_stale_, false)) return;
  calls_.watched("fmiFreeSlaveInstance", [&] { calls_.call("fmiFreeSlaveInstance", functions_->free_slave_instance); });
  calls_.instantiate_again("fmiInstantiateSlave", [this] { return instantiate(); });
  set_start_values();
  initialize();
}

void Fmi1Slave::set_start_values() {
  const auto set_all = [&](const auto& values, const char* name, auto* function) {
    for (const auto& [reference, value] : values) calls_.require(name, function, &reference, std::size_t{1}, &value);
  };
  set_all(start_.reals, "fmiSetReal", functions_->set_real);
  set_all(start_.integers, "fmiSetInteger", functions_->set_integer);
  set_all(start_.booleans, "fmiSetBoolean", functions_->set_boolean);
  for (const auto& [reference, value] : start_.strings) {
    const char* const text = value.c_str();
    calls_.require("fmiSetString", functions_->set_string, &reference, std::size_t{1}, &text);
  }
}

template <typename Value, typename Get>
bool Fmi1Slave::keep(std::map<ValueReference, Value>& kept, std::span<const ValueReference> references,
                     std::span<const Value> values, Get get) {
  if (phase_ == Phase::running) return false;
  for (std::size_t i = 0; i < references.size(); ++i) {
    const auto known = kept.find(references[i]);
    if (phase_ == Phase::initializing) {
      const bool is_same = known != kept.end() ? known->second == values[i] : get(references[i]) == values[i];
      is_stale_ = is_stale_ || !is_same;
    }
    kept.insert_or_assign(references[i], values[i]);
  }
  return phase_ == Phase::initializing;
}

StepResult Fmi1Slave::step(std::int64_t start_ns, std::int64_t duration_ns) {
  return steps_.step(start_ns, duration_ns, fmiTrue);
}

void Fmi1Slave::terminate() {
  if (!calls_.usable()) return;  // a step could not be cancelled
  calls_.watched("fmiTerminateSlave", [&] { calls_.require("fmiTerminateSlave", functions_->terminate_slave); });
}

std::uint32_t Fmi1Slave::output_derivative_order() const {
  const bool is_there = functions_->get_real_output_derivatives != nullptr;
  return is_there ? description().co_simulation->max_output_derivative_order : 0;
}

bool Fmi1Slave::takes_input_derivatives() const {
  return description().co_simulation->can_interpolate_inputs && functions_->set_real_input_derivatives != nullptr;
}

void Fmi1Slave::get_output_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                                       std::span<double> values) {
  calls_.require("fmiGetRealOutputDerivatives", functions_->get_real_output_derivatives,
                 negated_.in_fmu(references).data(), references.size(), orders.data(), values.data());
  negated_.for_each_negated(references, [&](std::size_t i) { values[i] = -values[i]; });
}

void Fmi1Slave::set_input_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                                      std::span<const double> values) {
  reals_.assign(values.begin(), values.end());
  negated_.for_each_negated(references, [&](std::size_t i) { reals_[i] = -reals_[i]; });
  calls_.require("fmiSetRealInputDerivatives", functions_->set_real_input_derivatives,
                 negated_.in_fmu(references).data(), references.size(), orders.data(), reals_.data());
}

void Fmi1Slave::get_reals(std::span<const ValueReference> references, std::span<double> values) {
  initialize_anew();
  calls_.require("fmiGetReal", functions_->get_real, negated_.in_fmu(references).data(), references.size(),
                 values.data());
  negated_.for_each_negated(references, [&](std::size_t i) { values[i] = -values[i]; });
}

void Fmi1Slave::get_integers(std::span<const ValueReference> references, std::span<std::int64_t> values) {
  initialize_anew();
  numbers_.resize(references.size());
  calls_.require("fmiGetInteger", functions_->get_integer, negated_.in_fmu(references).data(), references.size(),
                 numbers_.data());
  std::ranges::copy(numbers_, values.begin());
  negated_.for_each_negated(references, [&](std::size_t i) { values[i] = -values[i]; });
}

void Fmi1Slave::get_booleans(std::span<const ValueReference> references, std::span<std::int64_t> values) {
  initialize_anew();
  flags_.resize(references.size());
  calls_.require("fmiGetBoolean", functions_->get_boolean, negated_.in_fmu(references).data(), references.size(),
                 flags_.data());
  std::ranges::transform(flags_, values.begin(), [](fmiBoolean value) { return value == fmiFalse ? 0 : 1; });
  negated_.for_each_negated(references, [&](std::size_t i) { values[i] = 1 - values[i]; });
}

void Fmi1Slave::get_strings(std::span<const ValueReference> references, std::span<std::string> values) {
  initialize_anew();
  texts_.assign(references.size(), nullptr);
  calls_.require("fmiGetString", functions_->get_string, references.data(), references.size(), texts_.data());
  calls_.copy_texts("fmiGetString", references, texts_, values);
}

template <typename Value, typename Function>
Value Fmi1Slave::present(const char* name, Function* function, ValueReference reference) {
  Value value{};
  calls_.require(name, function, &reference, std::size_t{1}, &value);
  return value;
}

void Fmi1Slave::set_reals(std::span<const ValueReference> references, std::span<const double> values) {
  reals_.assign(values.begin(), values.end());
  negated_.for_each_negated(references, [&](std::size_t i) { reals_[i] = -reals_[i]; });
  const auto known = negated_.in_fmu(references);
  const auto get = [&](auto reference) { return present<double>("fmiGetReal", functions_->get_real, reference); };
  if (keep<double>(start_.reals, known, reals_, get)) return;
  calls_.require("fmiSetReal", functions_->set_real, known.data(), known.size(), reals_.data());
}

/// Sets Integers. The values fit into 32 bits, because `resolve` and Ensemble check their range.
void Fmi1Slave::set_integers(std::span<const ValueReference> references, std::span<const std::int64_t> values) {
  numbers_.resize(values.size());
  std::ranges::transform(values, numbers_.begin(), [](std::int64_t value) { return static_cast<fmiInteger>(value); });
  negated_.for_each_negated(references, [&](std::size_t i) {
    if (values[i] == std::numeric_limits<fmiInteger>::min())
      calls_.fail("fmiSetInteger",
                  fmt::format("cannot set a negated alias to {}: its negative needs more than 32 bits", values[i]));
    numbers_[i] = static_cast<fmiInteger>(-values[i]);
  });
  const auto known = negated_.in_fmu(references);
  const auto get = [&](auto reference) {
    return present<fmiInteger>("fmiGetInteger", functions_->get_integer, reference);
  };
  if (keep<fmiInteger>(start_.integers, known, numbers_, get)) return;
  calls_.require("fmiSetInteger", functions_->set_integer, known.data(), known.size(), numbers_.data());
}

void Fmi1Slave::set_booleans(std::span<const ValueReference> references, std::span<const std::int64_t> values) {
  flags_.resize(values.size());
  std::ranges::transform(values, flags_.begin(), [](std::int64_t value) { return value == 0 ? fmiFalse : fmiTrue; });
  negated_.for_each_negated(references, [&](std::size_t i) { flags_[i] = values[i] == 0 ? fmiTrue : fmiFalse; });
  const auto known = negated_.in_fmu(references);
  const auto get = [&](auto reference) {
    return present<fmiBoolean>("fmiGetBoolean", functions_->get_boolean, reference);
  };
  if (keep<fmiBoolean>(start_.booleans, known, flags_, get)) return;
  calls_.require("fmiSetBoolean", functions_->set_boolean, known.data(), known.size(), flags_.data());
}

void Fmi1Slave::set_strings(std::span<const ValueReference> references, std::span<const std::string> values) {
  const auto get = [&](ValueReference reference) {
    std::string text;
    get_strings({&reference, 1}, {&text, 1});
    return text;
  };
  if (keep<std::string>(start_.strings, references, values, get)) return;
  texts_.clear();
  for (const auto& value : values) texts_.push_back(value.c_str());
  calls_.require("fmiSetString", functions_->set_string, references.data(), references.size(), texts_.data());
}

namespace {

[[noreturn]] void fail_without_states(const Fmi1Slave& slave) {
  throw Error(ErrorCode::not_offered,
              fmt::format("instance '{}': its FMU cannot save its state (FMI 1.0 has no states)", slave.name()));
}

}  // namespace

std::unique_ptr<SlaveState> Fmi1Slave::save_state() {
  fail_without_states(*this);
}

void Fmi1Slave::restore_state(const SlaveState& /*state*/) {
  fail_without_states(*this);
}

std::vector<std::byte> Fmi1Slave::serialize(const SlaveState& /*state*/) {
  fail_without_states(*this);
}

std::unique_ptr<SlaveState> Fmi1Slave::deserialize(std::span<const std::byte> /*bytes*/) {
  fail_without_states(*this);
}

}  // namespace mebots::master
