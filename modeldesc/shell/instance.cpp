// SPDX-License-Identifier: Apache-2.0
#include "instance.hpp"

#include "mebots/assert.hpp"
#include "mebots/error.hpp"
#include "mebots/fmu/binary_ref.hpp"
#include "mebots/state/layout.hpp"
#include "mebots/state/save.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

namespace mebots::shell {
namespace {

/// Converts FMI's seconds to nanoseconds.
std::int64_t to_ns(double time_s, std::string_view what) {
  constexpr double kLimit_s = 9.2e9;  // 292 years fill 63 bits of nanoseconds
  if (!(std::abs(time_s) < kLimit_s))
    throw Error(fmt::format("{} = {} s: a time within +-{:g} s is needed", what, time_s, kLimit_s));
  return std::llround(time_s * 1e9);
}

double to_s(std::int64_t time_ns) {
  return static_cast<double>(time_ns) / 1e9;
}

/// Returns the greatest difference at which two times count as equal. Tools that add up steps accumulate rounding
/// errors. With steps of at least 4 us, the difference is at most half a step, so that communication points are
/// distinct.
double time_tolerance_s(double time_s, double step_s) {
  return 1e-6 + std::min(1e-9 * std::abs(time_s), step_s / 4);
}

}  // namespace

Instance::Instance(const Definition& definition, const Version& version, Logger logger, std::filesystem::path resources)
    : definition_(definition),
      version_(version),
      logger_(std::move(logger)),
      resources_(std::move(resources)),
      variables_(definition.make_variables()) {}

void Instance::setup_experiment(double start_s, std::optional<double> stop_s) {
  MEBOTS_ASSERT(state_ == State::instantiated);
  const std::int64_t start_ns = to_ns(start_s, "startTime");
  std::optional<std::int64_t> stop_ns;
  if (stop_s) {
    stop_ns = to_ns(*stop_s, "stopTime");
    if (*stop_ns < start_ns) throw Error(fmt::format("stopTime {} s is before startTime {} s", *stop_s, start_s));
  }
  start_ns_ = start_ns;
  time_ns_ = start_ns;
  stop_ns_ = stop_ns;
  experiment_is_set_ = true;
}

void Instance::enter_configuration() {
  if (std::ranges::none_of(definition_.variables, &Variable::is_structural))
    throw Error("this FMU has no structural parameter to configure");
  state_ = State::configuration;
}

void Instance::exit_configuration() {
  state_ = State::instantiated;
}

void Instance::enter_initialization() {
  MEBOTS_ASSERT(state_ == State::instantiated);
  if (!experiment_is_set_)
    throw Error(fmt::format("the start time is not known; call {} first", version_.experiment_function));
  state_ = State::initialization;
}

void Instance::exit_initialization() {
  MEBOTS_ASSERT(state_ == State::initialization, "the table of legal calls excludes all other states");
  try {
    bring_model_up_to_date();
    deliver_held_messages();
  } catch (const Error&) {
    state_ = State::error;
    throw;
  }
  state_ = State::step_complete;
}

void Instance::terminate() {
  if (model_) model_->terminate();
  state_ = State::terminated;
}

void Instance::reset() {
  model_.reset();
  variables_ = definition_.make_variables();
  binaries_.clear();
  model_is_stale_ = true;
  experiment_is_set_ = false;
  start_ns_ = 0;
  time_ns_ = 0;
  stop_ns_.reset();
  last_step_status_ = Status::ok;
  state_ = State::instantiated;
}

void Instance::bring_model_up_to_date() {
  if (model_ && !model_is_stale_) return;
  model_.reset();
  const std::shared_ptr<void> fresh = definition_.make_variables();
  copy_values(definition_, Causality::output, fresh.get(), variables_.get());
  take(make_model(variables_.get(), start_ns_));
  model_is_stale_ = false;
  MEBOTS_ASSERT(model_ != nullptr);
}

std::unique_ptr<Model> Instance::make_model(void* variables, std::int64_t start_ns) {
  held_.clear();
  holds_messages_ = true;
  try {
    auto model = definition_.make_model(variables, *this, start_ns);
    holds_messages_ = false;
    return model;
  } catch (...) {
    holds_messages_ = false;
    throw;
  }
}

void Instance::deliver_held_messages() {
  for (const HeldMessage& held : held_) log(held.severity, held.category, held.text);
  held_.clear();
}

void Instance::log(Severity severity, std::string_view category, std::string_view message) {
  if (holds_messages_ && severity != Severity::error) {
    held_.push_back({severity, std::string(category), std::string(message)});
    return;
  }
  const Status status = severity == Severity::error     ? Status::error
                        : severity == Severity::warning ? Status::warning
                                                        : Status::ok;
  logger_.log(status, category, message);
}

template <typename T, typename Read>
void Instance::get_values(References references, std::span<T> values, Type type, Read read) {
  texts_made_.clear();
  for (std::size_t i = 0; i < references.size(); ++i) {
    const Variable& variable = find_variable(definition_, references[i], type);
    const bool started = state_ != State::instantiated && state_ != State::configuration;
    if (!started && variable.causality == Causality::output)
      throw Error(
          fmt::format("{} has no value yet: {}EnterInitializationMode comes first", variable.name, version_.prefix));
    if (state_ == State::initialization && variable.causality == Causality::output) bring_model_up_to_date();
    values[i] = read(variable);
  }
}

void Instance::get(References references, std::span<fmi2Real> values) {
  get_values(references, values, Type::real, [&](const Variable& v) { return field<double>(variables_.get(), v); });
}

void Instance::get(References references, std::span<fmi2Integer> values) {
  get_values(references, values, Type::integer,
             [&](const Variable& v) { return field<std::int32_t>(variables_.get(), v); });
}

void Instance::get_booleans(References references, std::span<fmi2Boolean> values) {
  get_values(references, values, Type::boolean,
             [&](const Variable& v) { return field<bool>(variables_.get(), v) ? fmi2True : fmi2False; });
}

void Instance::get(References references, std::span<fmi2String> values) {
  get_values(references, values, Type::string, [&](const Variable& v) {
    if (v.offset != kNoField) return field<std::string>(variables_.get(), v).c_str();
    if (!model_)
      throw Error(
          fmt::format("{} does not exist, because initialisation failed; call {}Reset", v.name, version_.prefix));
    return texts_made_.emplace_back(model_->on_demand_text(v.name)).c_str();
  });
}

void Instance::check_may_set(const Variable& variable) const {
  if (variable.causality == Causality::output)
    throw Error(fmt::format("{} is an output, which only the model sets", variable.name));
  const bool initialised =
      state_ != State::instantiated && state_ != State::configuration && state_ != State::initialization;
  if (initialised && variable.variability == Variability::fixed)
    throw Error(
        fmt::format("{} is a fixed parameter: set it before {}ExitInitializationMode, or call {}Reset to start over",
                    variable.name, version_.prefix, version_.prefix));
}

template <typename T, typename Check, typename Write>
void Instance::set_values(References references, std::span<const T> values, Type type, Check check, Write write) {
  for (std::size_t i = 0; i < references.size(); ++i) {
    const Variable& variable = find_variable(definition_, references[i], type);
    check_may_set(variable);
    check(variable, values[i]);
  }
  for (std::size_t i = 0; i < references.size(); ++i) write(definition_.variables[references[i]], values[i]);
  if (state_ != State::step_complete) model_is_stale_ = true;
}

void Instance::set(References references, std::span<const fmi2Real> values) {
  set_values(
      references, values, Type::real, [](const Variable& v, fmi2Real value) { check_value(v, value); },
      [&](const Variable& v, fmi2Real value) { field<double>(variables_.get(), v) = value; });
}

void Instance::set(References references, std::span<const fmi2Integer> values) {
  set_values(
      references, values, Type::integer, [](const Variable& v, fmi2Integer value) { check_value(v, value); },
      [&](const Variable& v, fmi2Integer value) { field<std::int32_t>(variables_.get(), v) = value; });
}

void Instance::set_booleans(References references, std::span<const fmi2Boolean> values) {
  set_values(references, values, Type::boolean, check_boolean,
             [&](const Variable& v, fmi2Boolean value) { field<bool>(variables_.get(), v) = value == fmi2True; });
}

void Instance::set(References references, std::span<const fmi2String> values) {
  set_values(
      references, values, Type::string, [](const Variable& v, fmi2String value) { check_value(v, value); },
      [&](const Variable& v, fmi2String value) { field<std::string>(variables_.get(), v) = value; });
}

std::span<const std::uint8_t> Instance::get_binary(fmi2ValueReference reference) {
  const std::array rows = {reference, reference + 1, reference + 2};
  fmu::BinaryRef binary;
  std::array<fmi2Integer, 3> parts{};
  get(rows, parts);
  std::tie(binary.base_lo, binary.base_hi, binary.size) = std::tuple_cat(parts);
  return binary.bytes();
}

void Instance::set_binary(fmi2ValueReference reference, std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> kept(bytes.begin(), bytes.end());
  const auto binary = fmu::BinaryRef::to(kept);
  const std::array rows = {reference, reference + 1, reference + 2};
  const std::array<fmi2Integer, 3> parts = {binary.base_lo, binary.base_hi, binary.size};
  set(rows, parts);
  binaries_[reference] = std::move(kept);
}

std::size_t Instance::elements_of(const Variable& variable) const {
  if (variable.size_row == fmu::kFixedSize) return variable.elements;
  const auto size =
      field<std::int32_t>(static_cast<const void*>(variables_.get()), definition_.variables[variable.size_row]);
  return std::min(variable.elements, variable.per_size * static_cast<std::size_t>(std::max(size, std::int32_t{0})));
}

const std::filesystem::path& Instance::resources() const {
  if (resources_.empty()) throw Error("the importing tool passed no path of the FMU's resources");
  return resources_;
}

void Instance::do_step(double point_s, double step_s) {
  if (!(step_s > 0) || !std::isfinite(step_s))
    throw Error(fmt::format("communicationStepSize = {} s: a step above 0 is needed", step_s));
  const double own_s = to_s(time_ns_);
  if (!(std::abs(point_s - own_s) <= time_tolerance_s(own_s, step_s)))
    throw Error(fmt::format("currentCommunicationPoint = {} s, but this instance is at {} s", point_s, own_s));
  const std::int64_t end_ns = to_ns(point_s + step_s, "end of the step");
  // Tools that add up steps may end with a step of about 2e-13 s, which starts and ends in the same nanosecond.
  if (end_ns <= time_ns_) return;
  if (stop_ns_ && to_s(end_ns - *stop_ns_) > time_tolerance_s(to_s(*stop_ns_), step_s))
    throw Error(fmt::format("the step would end at {} s, after the stopTime of {} s given to {}", to_s(end_ns),
                            to_s(*stop_ns_), version_.experiment_function));
  last_step_status_ = Status::error;
  MEBOTS_ASSERT(model_ != nullptr && !model_is_stale_, "a step comes after initialisation");
  MEBOTS_ASSERT(end_ns > time_ns_);
  try {
    model_->step(time_ns_, end_ns - time_ns_);
  } catch (const Error&) {
    state_ = State::error;
    throw;
  }
  time_ns_ = end_ns;
  last_step_status_ = Status::ok;
}

double Instance::time_s() const {
  return to_s(time_ns_);
}

void Instance::take(std::unique_ptr<Model> model) {
  model_ = std::move(model);
  layout_ = model_ ? state::layout_of(*model_) : 0;
}

std::vector<std::byte> Instance::values(Causality causality) {
  return state::save(
      KeptValues(definition_, causality, variables_.get(), version_.keeps_binaries ? &binaries_ : nullptr));
}

SavedState Instance::save() {
  SavedState saved;
  saved.state = state_;
  saved.experiment_is_set = experiment_is_set_;
  saved.model_is_stale = model_is_stale_;
  saved.start_ns = start_ns_;
  saved.time_ns = time_ns_;
  saved.stop_ns = stop_ns_;
  saved.parameters = values(Causality::parameter);
  saved.inputs = values(Causality::input);
  saved.outputs = values(Causality::output);
  if (model_) {
    saved.model = state::save(*model_);
    saved.layout = layout_;
  }
  return saved;
}

void Instance::restore(const SavedState& saved) {
  Binaries binaries;
  const auto restore_into = [&](void* variables, Causality causality, const std::vector<std::byte>& bytes) {
    KeptValues values(definition_, causality, variables, version_.keeps_binaries ? &binaries : nullptr);
    state::restore(values, bytes);
  };
  const auto restore_all = [&](void* variables, Model* model) {
    restore_into(variables, Causality::parameter, saved.parameters);
    restore_into(variables, Causality::input, saved.inputs);
    restore_into(variables, Causality::output, saved.outputs);
    if (model == nullptr) return;
    state::restore(*model, *saved.model);
  };
  const auto check_layout = [&](std::uint64_t layout) {
    if (saved.layout != layout)
      throw Error(
          ErrorCode::state_of_other_build,
          fmt::format("the state was saved by another build of {}, whose variables have another layout (layout {:016x} "
                      "there, {:016x} here); restore it with that build, or run from the start again",
                      definition_.model_identifier, saved.layout, layout));
  };

  // If the current model has the same parameters, restores its state in place. Otherwise replaces the model.
  const bool in_place = model_ && saved.model && !model_is_stale_ && state_ != State::error &&
                        start_ns_ == saved.start_ns && values(Causality::parameter) == saved.parameters;
  if (in_place) {
    check_layout(layout_);
    try {
      restore_all(variables_.get(), model_.get());
    } catch (...) {
      binaries_ = std::move(binaries);  // the inputs may point into them
      state_ = State::error;
      throw;
    }
  } else {
    const std::shared_ptr<void> variables = definition_.make_variables();
    std::unique_ptr<Model> model;
    if (saved.model) {
      restore_into(variables.get(), Causality::parameter, saved.parameters);
      restore_into(variables.get(), Causality::input, saved.inputs);
      model = make_model(variables.get(), saved.start_ns);
      held_.clear();  // messages from before the restore
      check_layout(state::layout_of(*model));
    }
    restore_all(variables.get(), model.get());
    take(std::move(model));  // destroy the old model before its variables
    variables_ = variables;
  }
  binaries_ = std::move(binaries);
  state_ = saved.state;
  experiment_is_set_ = saved.experiment_is_set;
  model_is_stale_ = saved.model_is_stale;
  start_ns_ = saved.start_ns;
  time_ns_ = saved.time_ns;
  stop_ns_ = saved.stop_ns;
  last_step_status_ = Status::ok;
}

}  // namespace mebots::shell
