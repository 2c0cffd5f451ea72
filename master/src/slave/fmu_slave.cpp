// SPDX-License-Identifier: Apache-2.0
#include "slave/fmu_slave.hpp"

#include "base/time.hpp"
#include "mebots/assert.hpp"
#include "mebots/fmi2/status_name.hpp"
#include "mebots/input_error.hpp"
#include "mebots/state/bytes.hpp"

#include "slave/fmi2_functions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <type_traits>

namespace mebots::master {
namespace {

static_assert(std::is_same_v<fmi2Integer, std::int32_t>);
static_assert(std::is_same_v<fmi2Boolean, std::int32_t>);
static_assert(std::is_same_v<fmi2ValueReference, ValueReference>);

constexpr std::size_t kLastWords = 5;

Severity severity_of(int status) {
  if (status == fmi2OK) return Severity::info;
  return status == fmi2Warning || status == fmi2Discard || status == fmi2Pending ? Severity::warning : Severity::error;
}

std::string formatted(const char* format, std::va_list arguments) {
  std::va_list counted;
  va_copy(counted, arguments);
  const int length = std::vsnprintf(nullptr, 0, format, counted);
  va_end(counted);
  if (length < 0) return format;
  std::string text(static_cast<std::size_t>(length), '\0');
  std::vsnprintf(text.data(), text.size() + 1, format, arguments);
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  return text;
}

modeldesc::Type type_of_letter(char letter) {
  switch (letter) {
    case 'r':
      return modeldesc::Type::real;
    case 'i':
      return modeldesc::Type::integer;
    case 'b':
      return modeldesc::Type::boolean;
    default:
      return modeldesc::Type::string;
  }
}

}  // namespace

struct FmuSlave::Fmi {
  fmi2CallbackFunctions callbacks{};
  fmi2Component component = nullptr;

  // The C interface of the standard: printf-like and called by foreign code, so nothing may be thrown out of it.
  static void log(fmi2ComponentEnvironment environment, fmi2String /*instance*/, fmi2Status status, fmi2String category,
                  fmi2String message, ...) {
    if (environment == nullptr || message == nullptr) return;
    std::va_list arguments;
    va_start(arguments, message);
    try {
      static_cast<FmuSlave*>(environment)
          ->logged(status, category == nullptr ? "" : category, formatted(message, arguments));
    } catch (...) {  // NOLINT(bugprone-empty-catch): a message is lost, the simulation is not
    }
    va_end(arguments);
  }

  static void step_finished(fmi2ComponentEnvironment environment, fmi2Status status) {
    if (environment != nullptr) static_cast<FmuSlave*>(environment)->step_finished(status);
  }
};

namespace {

/// State handle of an in-process FMU, and the time that its messages have. Counts itself in `kept`.
class FmuSlaveState final : public SlaveState {
 public:
  FmuSlaveState(const Fmi2Functions& functions, fmi2Component component, std::int64_t message_time_ns, int& kept)
      : time_ns(message_time_ns), functions_(&functions), component_(component), kept_(&kept) {
    ++*kept_;
  }
  ~FmuSlaveState() override {
    --*kept_;
    if (state != nullptr && functions_->free_fmu_state != nullptr) functions_->free_fmu_state(component_, &state);
  }
  FmuSlaveState(const FmuSlaveState&) = delete;
  FmuSlaveState& operator=(const FmuSlaveState&) = delete;

  fmi2FMUstate state = nullptr;
  std::int64_t time_ns;

 private:
  const Fmi2Functions* functions_;
  fmi2Component component_;
  int* kept_;
};

}  // namespace

FmuSlave::FmuSlave(std::string name, std::shared_ptr<Fmu> fmu, std::vector<std::string> log_categories,
                   MessageSink& messages)
    : name_(std::move(name)),
      fmu_(std::move(fmu)),
      log_categories_(std::move(log_categories)),
      sink_(&messages),
      functions_(&fmu_->functions()),
      fmi_(std::make_unique<Fmi>()) {
  fmi_->callbacks.logger = &Fmi::log;
  fmi_->callbacks.allocateMemory = &std::calloc;
  fmi_->callbacks.freeMemory = &std::free;
  const bool asynchronous = description().co_simulation->can_run_asynchronuously;
  fmi_->callbacks.stepFinished = asynchronous ? &Fmi::step_finished : nullptr;
  fmi_->callbacks.componentEnvironment = this;
  // Logging is on from the start: many FMUs say nothing about a failing instantiation otherwise.
  fmi_->component = functions_->instantiate(name_.c_str(), fmi2CoSimulation, description().guid.c_str(),
                                            fmu_->resource_uri().c_str(), &fmi_->callbacks, fmi2False, fmi2True);
  if (fmi_->component == nullptr) fail("fmi2Instantiate", "gave no instance");
  MEBOTS_ASSERT(!unusable_ && !pending_);
  deliver_held();
  choose_categories();
}

FmuSlave::~FmuSlave() {
  if (fmi_->component == nullptr || unusable_ || fmu_->corrupted()) return;
  if (pending_ && functions_->cancel_step != nullptr) functions_->cancel_step(fmi_->component);
  functions_->free_instance(fmi_->component);
}

void FmuSlave::choose_categories() {
  if (functions_->set_debug_logging == nullptr) return;
  static constexpr std::string_view kAlways[] = {"logStatusWarning", "logStatusDiscard", "logStatusError",
                                                 "logStatusFatal"};
  const auto wanted = [&](const std::string& category) {
    return std::find(log_categories_.begin(), log_categories_.end(), category) != log_categories_.end() ||
           std::find(std::begin(kAlways), std::end(kAlways), category) != std::end(kAlways);
  };
  if (std::find(log_categories_.begin(), log_categories_.end(), "*") != log_categories_.end()) return;
  std::vector<fmi2String> chosen;
  for (const auto& category : description().log_categories) {
    if (wanted(category.name)) chosen.push_back(category.name.c_str());
  }
  // An FMU without a category of interest keeps logging everything; what is not wanted is dropped here.
  if (chosen.empty()) return;
  check(functions_->set_debug_logging(fmi_->component, fmi2True, chosen.size(), chosen.data()), "fmi2SetDebugLogging");
}

void FmuSlave::logged(int status, std::string_view category, std::string text) {
  const std::lock_guard lock(log_mutex_);
  const auto severity = severity_of(status);
  text = with_names(text);
  if (severity != Severity::info) {
    last_words_.push_back(text);
    if (last_words_.size() > kLastWords) last_words_.pop_front();
  }
  if (severity == Severity::error) {
    held_.push_back({std::string(category), std::move(text)});
    return;
  }
  const bool shown = severity == Severity::warning ||
                     std::any_of(log_categories_.begin(), log_categories_.end(),
                                 [&](const std::string& wanted) { return wanted == "*" || wanted == category; });
  if (shown) sink_->message({name_, severity, category, text, time_ns_});
}

std::string FmuSlave::with_names(std::string_view text) const {
  // FMI: "#r12#" in a message stands for the name of the Real variable with value reference 12, "##" for "#".
  std::string result;
  std::size_t at = 0;
  while (at < text.size()) {
    const auto hash = text.find('#', at);
    result += text.substr(at, hash - at);
    if (hash == std::string_view::npos) break;
    const auto end = text.find('#', hash + 1);
    if (end == std::string_view::npos) {
      result += text.substr(hash);
      break;
    }
    const auto inside = text.substr(hash + 1, end - hash - 1);
    const auto digits = inside.empty() ? inside : inside.substr(1);
    const bool reference = inside.size() >= 2 && inside.size() < 12 &&
                           std::string_view("ribs").find(inside[0]) != std::string_view::npos &&
                           std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (inside.empty()) {
      result += '#';
    } else if (reference) {
      const auto number = std::stoull(std::string(digits));
      const auto& variables = description().variables;
      const auto found = std::find_if(variables.begin(), variables.end(), [&](const modeldesc::Variable& variable) {
        const auto type = variable.type == modeldesc::Type::enumeration ? modeldesc::Type::integer : variable.type;
        return variable.value_reference == number && type == type_of_letter(inside[0]);
      });
      result += found == variables.end() ? std::string(inside) : found->name;
    } else {
      result += '#';
      at = hash + 1;
      continue;
    }
    at = end + 1;
  }
  return result;
}

void FmuSlave::deliver_held() {
  const std::lock_guard lock(log_mutex_);
  for (const auto& held : held_) sink_->message({name_, Severity::error, held.category, held.text, time_ns_});
  held_.clear();
}

std::string FmuSlave::said() const {
  if (last_words_.empty()) return "The FMU logged nothing about it.";
  std::string text = "The FMU said: ";
  for (std::size_t i = 0; i < last_words_.size(); ++i) text += (i == 0 ? "" : "; ") + last_words_[i];
  return text;
}

void FmuSlave::fail(const char* function, std::string_view what) {
  const std::lock_guard lock(log_mutex_);
  held_.clear();  // they are in the exception
  throw SlaveError(
      fmt::format("instance '{}' at {} s: {} {}. {}", name_, to_seconds(time_ns_), function, what, said()));
}

void FmuSlave::check(int status, const char* function) {
  if (status == fmi2OK || status == fmi2Warning) {
    if (!held_.empty()) deliver_held();
    return;
  }
  if (status == fmi2Fatal) {
    unusable_ = true;
    fmu_->set_corrupted();  // the standard says so of all instances of this FMU
  }
  fail(function, fmt::format("answered {}", fmi2::status_name(static_cast<fmi2Status>(status))));
}

void FmuSlave::setup_experiment(std::int64_t start_ns, std::int64_t stop_ns) {
  time_ns_ = start_ns;
  check(
      functions_->setup_experiment(fmi_->component, fmi2False, 0, to_seconds(start_ns), fmi2True, to_seconds(stop_ns)),
      "fmi2SetupExperiment");
}

void FmuSlave::enter_initialization() {
  check(functions_->enter_initialization_mode(fmi_->component), "fmi2EnterInitializationMode");
}

void FmuSlave::exit_initialization() {
  check(functions_->exit_initialization_mode(fmi_->component), "fmi2ExitInitializationMode");
}

StepResult FmuSlave::step(std::int64_t start_ns, std::int64_t duration_ns) {
  time_ns_ = start_ns;
  step_end_ns_ = start_ns + duration_ns;
  {
    const std::lock_guard lock(step_mutex_);
    step_status_.reset();
  }
  // Nobody can set it back to before this point when there is no state to go back to.
  const bool never_back = kept_states_ == 0;
  if (never_back) promised_ns_ = start_ns;
  const auto status = functions_->do_step(fmi_->component, to_seconds(start_ns), to_seconds(duration_ns),
                                          never_back ? fmi2True : fmi2False);
  if (status != fmi2Pending) return step_ended(status);
  if (functions_->get_status == nullptr && fmi_->callbacks.stepFinished == nullptr) {
    fail("fmi2DoStep", "answered fmi2Pending, but the FMU has no fmi2GetStatus to ask when the step is over");
  }
  pending_ = true;
  StepResult result;
  result.done = false;
  result.pending = true;
  return result;
}

void FmuSlave::step_finished(int status) {
  {
    const std::lock_guard lock(step_mutex_);
    step_status_ = status;
  }
  step_over_.notify_all();
}

/// The status of a pending step once it is over; fmi2Pending when it was given up. An FMU says that it is over by
/// its callback, when asked by fmi2GetStatus, or both; asking gets rarer, from every 20 us to every 2 ms.
int FmuSlave::wait_for_step(const std::atomic<bool>& cancel) {
  constexpr std::chrono::microseconds kLongestPause{2000};
  std::chrono::microseconds pause{20};
  while (!cancel.load(std::memory_order_relaxed)) {
    {
      std::unique_lock lock(step_mutex_);
      if (step_over_.wait_for(lock, pause, [this] { return step_status_.has_value(); })) return *step_status_;
    }
    pause = std::min(2 * pause, kLongestPause);
    if (functions_->get_status == nullptr) continue;
    fmi2Status status = fmi2Pending;
    if (functions_->get_status(fmi_->component, fmi2DoStepStatus, &status) == fmi2OK && status != fmi2Pending) {
      return status;
    }
  }
  return fmi2Pending;
}

StepResult FmuSlave::finish_step(const std::atomic<bool>& cancel) {
  if (!pending_) return Slave::finish_step(cancel);
  const auto status = wait_for_step(cancel);
  pending_ = false;
  if (status != fmi2Pending) return step_ended(status);
  if (functions_->cancel_step != nullptr) check(functions_->cancel_step(fmi_->component), "fmi2CancelStep");
  StepResult result;
  result.done = false;
  result.cancelled = true;
  return result;
}

StepResult FmuSlave::step_ended(int status) {
  if (status != fmi2Discard) {
    check(status, "fmi2DoStep");
    time_ns_ = step_end_ns_;  // what is said and asked next belongs to the step's end
    return {};
  }
  deliver_held();
  StepResult result;
  result.done = false;
  fmi2Boolean terminated = fmi2False;
  if (functions_->get_boolean_status != nullptr &&
      functions_->get_boolean_status(fmi_->component, fmi2Terminated, &terminated) == fmi2OK) {
    result.terminated = terminated != fmi2False;
  }
  fmi2Real last_successful_s = 0;
  if (functions_->get_real_status != nullptr &&
      functions_->get_real_status(fmi_->component, fmi2LastSuccessfulTime, &last_successful_s) == fmi2OK) {
    result.last_successful_s = last_successful_s;
  }
  result.messages = said();
  return result;
}

void FmuSlave::terminate() {
  check(functions_->terminate(fmi_->component), "fmi2Terminate");
}

std::uint32_t FmuSlave::output_derivative_order() const {
  return functions_->get_real_output_derivatives == nullptr ? 0
                                                            : description().co_simulation->max_output_derivative_order;
}

bool FmuSlave::takes_input_derivatives() const {
  return description().co_simulation->can_interpolate_inputs && functions_->set_real_input_derivatives != nullptr;
}

void FmuSlave::get_output_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                                      std::span<double> values) {
  check(functions_->get_real_output_derivatives(fmi_->component, references.data(), references.size(), orders.data(),
                                                values.data()),
        "fmi2GetRealOutputDerivatives");
  const auto bad = std::ranges::find_if(values, [](double value) { return !std::isfinite(value); });
  if (bad == values.end()) return;
  const auto index = static_cast<std::size_t>(bad - values.begin());
  const auto& variables = description().variables;
  const auto variable = std::ranges::find_if(variables, [&](const modeldesc::Variable& one) {
    return one.type == modeldesc::Type::real && one.value_reference == references[index];
  });
  throw NotFiniteError(fmt::format("instance '{}' at {} s: the time derivative (order {}) of '{}' is {}", name_,
                                   to_seconds(time_ns_), orders[index],
                                   variable == variables.end() ? "?" : variable->name, *bad));
}

void FmuSlave::set_input_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                                     std::span<const double> values) {
  check(functions_->set_real_input_derivatives(fmi_->component, references.data(), references.size(), orders.data(),
                                               values.data()),
        "fmi2SetRealInputDerivatives");
}

void FmuSlave::get_reals(std::span<const ValueReference> references, std::span<double> values) {
  check(functions_->get_real(fmi_->component, references.data(), references.size(), values.data()), "fmi2GetReal");
}

void FmuSlave::get_integers(std::span<const ValueReference> references, std::span<std::int32_t> values) {
  check(functions_->get_integer(fmi_->component, references.data(), references.size(), values.data()),
        "fmi2GetInteger");
}

void FmuSlave::get_booleans(std::span<const ValueReference> references, std::span<std::int32_t> values) {
  check(functions_->get_boolean(fmi_->component, references.data(), references.size(), values.data()),
        "fmi2GetBoolean");
}

void FmuSlave::get_strings(std::span<const ValueReference> references, std::span<std::string> values) {
  texts_.assign(references.size(), nullptr);
  check(functions_->get_string(fmi_->component, references.data(), references.size(), texts_.data()), "fmi2GetString");
  for (std::size_t i = 0; i < texts_.size(); ++i) values[i] = texts_[i] == nullptr ? "" : texts_[i];
}

void FmuSlave::set_reals(std::span<const ValueReference> references, std::span<const double> values) {
  check(functions_->set_real(fmi_->component, references.data(), references.size(), values.data()), "fmi2SetReal");
}

void FmuSlave::set_integers(std::span<const ValueReference> references, std::span<const std::int32_t> values) {
  check(functions_->set_integer(fmi_->component, references.data(), references.size(), values.data()),
        "fmi2SetInteger");
}

void FmuSlave::set_booleans(std::span<const ValueReference> references, std::span<const std::int32_t> values) {
  check(functions_->set_boolean(fmi_->component, references.data(), references.size(), values.data()),
        "fmi2SetBoolean");
}

void FmuSlave::set_strings(std::span<const ValueReference> references, std::span<const std::string> values) {
  texts_.clear();
  for (const auto& value : values) texts_.push_back(value.c_str());
  check(functions_->set_string(fmi_->component, references.data(), references.size(), texts_.data()), "fmi2SetString");
}

std::unique_ptr<SlaveState> FmuSlave::save_state() {
  if (!description().co_simulation->can_get_and_set_fmu_state || functions_->get_fmu_state == nullptr ||
      functions_->set_fmu_state == nullptr || functions_->free_fmu_state == nullptr) {
    throw Error(fmt::format("instance '{}': its FMU cannot save its state (canGetAndSetFMUstate is false)", name_));
  }
  auto state = std::make_unique<FmuSlaveState>(*functions_, fmi_->component, time_ns_, kept_states_);
  check(functions_->get_fmu_state(fmi_->component, &state->state), "fmi2GetFMUstate");
  return state;
}

void FmuSlave::restore_state(const SlaveState& state) {
  const auto& saved = static_cast<const FmuSlaveState&>(state);
  if (saved.time_ns < promised_ns_) {
    throw Error(fmt::format(
        "instance '{}': its state of {} s cannot be restored: at {} s no state was kept, so its FMU was told that it "
        "is not set back any more (noSetFMUStatePriorToCurrentPoint). Keep the state while the run goes on",
        name_, to_seconds(saved.time_ns), to_seconds(promised_ns_)));
  }
  check(functions_->set_fmu_state(fmi_->component, saved.state), "fmi2SetFMUstate");
  time_ns_ = saved.time_ns;
}

std::vector<std::byte> FmuSlave::serialize(const SlaveState& state) {
  if (!description().co_simulation->can_serialize_fmu_state || functions_->serialize_fmu_state == nullptr ||
      functions_->serialized_fmu_state_size == nullptr) {
    throw Error(
        fmt::format("instance '{}': its FMU cannot write its state as bytes (canSerializeFMUstate is false)", name_));
  }
  const auto& saved = static_cast<const FmuSlaveState&>(state);
  std::size_t size = 0;
  check(functions_->serialized_fmu_state_size(fmi_->component, saved.state, &size), "fmi2SerializedFMUstateSize");
  std::vector<std::byte> bytes(size);
  check(functions_->serialize_fmu_state(fmi_->component, saved.state, reinterpret_cast<fmi2Byte*>(bytes.data()), size),
        "fmi2SerializeFMUstate");
  state::Writer writer;
  writer.put(saved.time_ns);
  writer.put(bytes);
  return writer.take();
}

std::unique_ptr<SlaveState> FmuSlave::deserialize(std::span<const std::byte> bytes) {
  if (!description().co_simulation->can_serialize_fmu_state || functions_->deserialize_fmu_state == nullptr) {
    throw Error(
        fmt::format("instance '{}': its FMU cannot read its state from bytes (canSerializeFMUstate is false)", name_));
  }
  state::Reader reader(bytes);
  auto state = std::make_unique<FmuSlaveState>(*functions_, fmi_->component, reader.get<std::int64_t>(), kept_states_);
  std::vector<std::byte> own;
  reader.get(own);
  check(functions_->deserialize_fmu_state(fmi_->component, reinterpret_cast<const fmi2Byte*>(own.data()), own.size(),
                                          &state->state),
        "fmi2DeSerializeFMUstate");
  return state;
}

}  // namespace mebots::master
