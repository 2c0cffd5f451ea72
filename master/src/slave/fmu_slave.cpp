// SPDX-License-Identifier: Apache-2.0
#include "slave/fmu_slave.hpp"

#include "base/time.hpp"
#include "mebots/assert.hpp"
#include "mebots/fmi2/types.hpp"
#include "mebots/input_error.hpp"
#include "mebots/state/bytes.hpp"

#include "fmi/call/fmi2_callbacks.hpp"
#include "fmi/call/foreign_call.hpp"
#include "fmi/fmu.hpp"
#include "fmi/process/process_state.hpp"
#include "message/message_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <new>
#include <type_traits>
#include <utility>

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

struct FmuSlave::Fmi final : CallbackListener {
  explicit Fmi(FmuSlave& owner) : slave(&owner), target(*this, owner.name()) {}

  void logged(LoggerCall call) override {
    slave->logged(call.status, call.category, std::move(call.text), call.in_call);
  }
  void step_finished(int status) override { slave->step_finished(status); }

  /// Every call to the FMU goes through here. Throws SlaveError for a C++ exception that comes out of it.
  template <typename Function, typename... Arguments>
  [[gnu::always_inline]] auto call(const char* name, Function* function, Arguments... arguments) {
    return in_scope(name, [&] { return function(component, arguments...); });
  }

  template <typename Work>
  [[gnu::always_inline]] auto in_scope(const char* name, Work work) {
    const CallbackScope scope(target, name, slave->time_ns_);
    if (floats != ours) floats.enter();
    try {
      if constexpr (std::is_void_v<std::invoke_result_t<Work>>) {
        call_foreign(work);
        leave(name);
      } else {
        const auto result = call_foreign(work);
        leave(name);
        return result;
      }
    } catch (const ForeignException& exception) {
      leave_by_exception(name, exception);
    }
  }

  [[noreturn, gnu::noinline]] void leave_by_exception(const char* name, const ForeignException& exception) {
    leave(name);
    slave->unusable_ = true;  // its code did not run to the end
    slave->fail(name, exception.what());
  }

  /// Stores the FMU's floating-point environment for its next call, and enters the master's again.
  void leave(const char* name) {
    const auto found = FloatEnvironment::now();
    if (found != floats) [[unlikely]] {
      slave->tell_of_floats(found, name);
      floats = found;
    }
    if (floats != ours) ours.enter();
  }

  /// For a state's handle, which must not outlive the slave. Throws nothing.
  auto freeing(const Fmi2Functions& functions) {
    return [this, free = functions.free_fmu_state](fmi2FMUstate* state) {
      if (free == nullptr || slave->unusable_) return;
      try {
        call("fmi2FreeFMUstate", free, state);
      } catch (const SlaveError& error) {
        slave->sink_->message({slave->name_, Severity::error, "notice", error.what(), slave->time_ns_});
      }
    };
  }

  FmuSlave* slave;
  CallbackTarget target;
  fmi2CallbackFunctions callbacks{};
  fmi2Component component = nullptr;
  FloatEnvironment ours = FloatEnvironment::now();  // of who called the master
  FloatEnvironment floats;                          // of the instance
};

namespace {

/// State handle of an in-process FMU, and the time that its messages have. Counts itself in `kept`.
class FmuSlaveState final : public SlaveState {
 public:
  using Free = std::function<void(fmi2FMUstate*)>;

  FmuSlaveState(Free free, std::int64_t message_time_ns, int& kept)
      : time_ns(message_time_ns), free_(std::move(free)), kept_(&kept) {
    ++*kept_;
  }
  ~FmuSlaveState() override {
    --*kept_;
    if (state != nullptr) free_(&state);
  }
  FmuSlaveState(const FmuSlaveState&) = delete;
  FmuSlaveState& operator=(const FmuSlaveState&) = delete;

  fmi2FMUstate state = nullptr;
  std::int64_t time_ns;

 private:
  Free free_;
  int* kept_;
};

}  // namespace

FmuSlave::FmuSlave(std::string name, std::shared_ptr<Fmu> fmu, std::vector<std::string> log_categories,
                   MessageSink& messages, const TimeGrid& grid)
    : name_(std::move(name)),
      fmu_(std::move(fmu)),
      log_categories_(std::move(log_categories)),
      sink_(&messages),
      grid_(grid),
      functions_(&fmu_->functions()),
      fmi_(std::make_unique<Fmi>(*this)) {
  fmi_->callbacks = fmi_->target.functions(description().co_simulation->can_run_asynchronuously);
  // Logging is on from the start: many FMUs say nothing about a failing instantiation otherwise.
  const auto at_load = fmu_->take_changes_at_load();
  is_watched_ = fmu_->enter();
  watched_step_ = is_watched_ ? 1 : 0;
  if (const auto found = fmu_->floats_at_load()) tell_of_floats(*found, "loading its library");
  tell_of_process(at_load, "loading its library");
  watched("fmi2Instantiate", [&] {
    fmi_->component = fmi_->in_scope("fmi2Instantiate", [&] {
      return functions_->instantiate(name_.c_str(), fmi2CoSimulation, description().guid.c_str(),
                                     fmu_->resource_uri().c_str(), &fmi_->callbacks, fmi2False, fmi2True);
    });
  });
  if (fmi_->component == nullptr) fail("fmi2Instantiate", "gave no instance");
  MEBOTS_ASSERT(!unusable_ && !pending_);
  deliver_held();
  choose_categories();
}

FmuSlave::~FmuSlave() {
  FmuSlave::free_instance();
}

/// A crash takes the whole process down.
std::optional<std::string> FmuSlave::free_instance() {
  if (std::exchange(freed_, true)) return std::nullopt;
  std::optional<std::string> fault;
  try {
    if (fmi_->component != nullptr && !unusable_ && !fmu_->corrupted()) {
      if (pending_ && functions_->cancel_step != nullptr) fmi_->call("fmi2CancelStep", functions_->cancel_step);
      watched("fmi2FreeInstance", [&] { fmi_->call("fmi2FreeInstance", functions_->free_instance); });
    }
    deliver_held();
  } catch (const SlaveError& error) {
    fault = error.what();
    sink_->message({name_, Severity::error, "notice", *fault, time_ns_});
  }
  const auto threads = fmu_->leave();
  if (threads == 0) return fault;
  sink_->message({name_, Severity::warning, "notice",
                  fmt::format("{} that started after the FMU {} was loaded still {}, so its code stays in memory until "
                              "the program ends",
                              threads == 1 ? "a thread" : fmt::format("{} threads", threads),
                              fmu_->archive().filename().string(), threads == 1 ? "runs" : "run"),
                  time_ns_});
  return fault;
}

void FmuSlave::tell_of_floats(const FloatEnvironment& found, const char* where) {
  if (!fmu_->first_to_tell_of_floats()) return;
  const auto text =
      fmt::format("the FMU {} changed how its thread computes, in {}: {}; this holds for calls to the instance only",
                  fmu_->archive().filename().string(), where, difference_text(found, fmi_->floats));
  sink_->message({name_, Severity::warning, "notice", text, time_ns_});
}

void FmuSlave::tell_of_process(const std::vector<std::string>& changes, const char* where) {
  if (changes.empty()) return;
  const auto text = fmt::format("the FMU {} changed the process for all, in {}: {}",
                                fmu_->archive().filename().string(), where, fmt::join(changes, "; "));
  sink_->message({name_, Severity::warning, "notice", text, time_ns_});
}

/// Does the work and tells what it changed in the process.
template <typename Work>
void FmuSlave::watched(const char* where, Work work) {
  const auto reach = fmu_->imports().reach;
  if (!is_watched_ || reach == ProcessReach::nothing) return work();
  static std::mutex one_at_a_time;
  const std::unique_lock lock(one_at_a_time, std::try_to_lock);
  if (!lock.owns_lock()) return work();  // not waited for: the call of another thread may wait for this one
  const ProcessState before(fmu_->files_of_others(), reach);
  work();
  tell_of_process(before.put_right(), where);
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
  require("fmi2SetDebugLogging", functions_->set_debug_logging, fmi2True, chosen.size(), chosen.data());
}

void FmuSlave::logged(int status, std::string_view category, std::string text, bool in_call) {
  const std::lock_guard lock(log_mutex_);
  const auto severity = severity_of(status);
  text = with_names(text);
  if (severity != Severity::info) {
    last_words_.push_back(one_line(text));
    if (last_words_.size() > kLastWords) last_words_.pop_front();
  }
  const bool shown = severity != Severity::info ||
                     std::any_of(log_categories_.begin(), log_categories_.end(),
                                 [&](const std::string& wanted) { return wanted == "*" || wanted == category; });
  if (!shown) return;
  any_held_ = true;
  if (!limit_.take(text.size() + category.size())) return;
  if (in_call && severity != Severity::error) {
    sink_->message({name_, severity, category, text, time_ns_});
    return;
  }
  held_.push_back({severity, std::string(category), std::move(text)});
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
  deliver_but(0);
}

/// Drops the last ones. Under the mutex.
void FmuSlave::deliver_but(std::size_t last) {
  held_.resize(held_.size() - std::min(held_.size(), last));
  for (const auto& held : held_) sink_->message({name_, held.severity, held.category, held.text, time_ns_});
  held_.clear();
  if (const auto notice = limit_.restart()) sink_->message({name_, Severity::warning, "notice", *notice, time_ns_});
  any_held_ = false;
}

std::string FmuSlave::said() const {
  if (last_words_.empty()) return "The FMU logged nothing about it.";
  std::string text = "The FMU said: ";
  for (std::size_t i = 0; i < last_words_.size(); ++i) text += (i == 0 ? "" : "; ") + last_words_[i];
  return text;
}

void FmuSlave::fail(const char* function, std::string_view what) {
  const std::lock_guard lock(log_mutex_);
  const auto is_said = [this](const Held& held) {
    return std::ranges::find(last_words_, one_line(held.text)) != last_words_.end();
  };
  const auto first_said = std::find_if_not(held_.rbegin(), held_.rend(), is_said).base();
  deliver_but(static_cast<std::size_t>(held_.end() - first_said));  // those are in the exception
  throw SlaveError(
      fmt::format("instance '{}' at {} s: {} {}. {}", name_, to_seconds(time_ns_), function, what, said()));
}

void FmuSlave::check(int status, const char* function) {
  if (status == fmi2OK || status == fmi2Warning) {
    if (any_held_.load(std::memory_order_relaxed)) deliver_held();
    return;
  }
  if (status == fmi2Fatal) {
    unusable_ = true;
    fmu_->set_corrupted();  // the standard says so of all instances of this FMU
  }
  fail(function, fmt::format("answered {}", fmi2::status_name(static_cast<fmi2Status>(status))));
}

template <typename Function, typename... Arguments>
void FmuSlave::require(const char* name, Function* function, Arguments... arguments) {
  check(fmi_->call(name, function, arguments...), name);
}

void FmuSlave::setup_experiment(const Experiment& experiment) {
  time_ns_ = experiment.start_ns;
  const auto& [start_ns, stop_ns, tolerance] = experiment;
  watched("fmi2SetupExperiment", [&] {
    require("fmi2SetupExperiment", functions_->setup_experiment, tolerance ? fmi2True : fmi2False,
            tolerance.value_or(0), to_seconds(start_ns), stop_ns ? fmi2True : fmi2False,
            grid_.time_s(stop_ns.value_or(0)));
  });
}

void FmuSlave::enter_initialization() {
  watched("fmi2EnterInitializationMode",
          [&] { require("fmi2EnterInitializationMode", functions_->enter_initialization_mode); });
}

void FmuSlave::exit_initialization() {
  watched("fmi2ExitInitializationMode",
          [&] { require("fmi2ExitInitializationMode", functions_->exit_initialization_mode); });
}

/// Every step cannot be watched; the first, second, fourth ... are, so that whoever does wrong in all of them is named.
int FmuSlave::do_step(std::int64_t start_ns, std::int64_t duration_ns, bool never_back) {
  const auto call = [&] {
    return fmi_->call("fmi2DoStep", functions_->do_step, grid_.time_s(start_ns),
                      grid_.length_s(start_ns, start_ns + duration_ns), never_back ? fmi2True : fmi2False);
  };
  if (++steps_ != watched_step_) [[likely]]
    return call();
  watched_step_ *= 2;
  int status = fmi2OK;
  watched("fmi2DoStep", [&] { status = call(); });
  return status;
}

StepResult FmuSlave::step(std::int64_t start_ns, std::int64_t duration_ns) {
  time_ns_ = start_ns;
  step_end_ns_ = start_ns + duration_ns;
  if (fmi_->callbacks.stepFinished != nullptr) {
    const std::lock_guard lock(step_mutex_);
    step_status_.reset();
  }
  // Nobody can set it back to before this point when there is no state to go back to.
  const bool never_back = kept_states_ == 0;
  if (never_back) promised_ns_ = start_ns;
  const auto status = do_step(start_ns, duration_ns, never_back);
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
    if (fmi_->call("fmi2GetStatus", functions_->get_status, fmi2DoStepStatus, &status) == fmi2OK &&
        status != fmi2Pending) {
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
  if (functions_->cancel_step != nullptr) require("fmi2CancelStep", functions_->cancel_step);
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
      fmi_->call("fmi2GetBooleanStatus", functions_->get_boolean_status, fmi2Terminated, &terminated) == fmi2OK) {
    result.terminated = terminated != fmi2False;
  }
  fmi2Real last_successful_s = 0;
  if (functions_->get_real_status != nullptr && fmi_->call("fmi2GetRealStatus", functions_->get_real_status,
                                                           fmi2LastSuccessfulTime, &last_successful_s) == fmi2OK) {
    result.last_successful_s = last_successful_s;
  }
  result.messages = said();
  return result;
}

void FmuSlave::terminate() {
  watched("fmi2Terminate", [&] { require("fmi2Terminate", functions_->terminate); });
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
  require("fmi2GetRealOutputDerivatives", functions_->get_real_output_derivatives, references.data(), references.size(),
          orders.data(), values.data());
}

void FmuSlave::set_input_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                                     std::span<const double> values) {
  require("fmi2SetRealInputDerivatives", functions_->set_real_input_derivatives, references.data(), references.size(),
          orders.data(), values.data());
}

void FmuSlave::get_reals(std::span<const ValueReference> references, std::span<double> values) {
  require("fmi2GetReal", functions_->get_real, references.data(), references.size(), values.data());
}

void FmuSlave::get_integers(std::span<const ValueReference> references, std::span<std::int32_t> values) {
  require("fmi2GetInteger", functions_->get_integer, references.data(), references.size(), values.data());
}

void FmuSlave::get_booleans(std::span<const ValueReference> references, std::span<std::int32_t> values) {
  require("fmi2GetBoolean", functions_->get_boolean, references.data(), references.size(), values.data());
  for (auto& value : values) value = value == fmi2False ? fmi2False : fmi2True;
}

void FmuSlave::get_strings(std::span<const ValueReference> references, std::span<std::string> values) {
  texts_.assign(references.size(), nullptr);
  require("fmi2GetString", functions_->get_string, references.data(), references.size(), texts_.data());
  for (std::size_t i = 0; i < texts_.size(); ++i) {
    const auto text = read_text(texts_[i], std::numeric_limits<std::size_t>::max());
    if (!text && texts_[i] != nullptr) {
      fail("fmi2GetString", fmt::format("gave the address {} for the text of {}, and nothing can be read there",
                                        fmt::ptr(texts_[i]), string_name(references[i])));
    }
    values[i] = text.value_or("");
  }
}

std::string FmuSlave::string_name(ValueReference reference) const {
  const auto& variables = description().variables;
  const auto found = std::ranges::find_if(variables, [&](const modeldesc::Variable& variable) {
    return variable.type == modeldesc::Type::string && variable.value_reference == reference;
  });
  return found == variables.end() ? fmt::format("reference {}", reference) : found->name;
}

void FmuSlave::set_reals(std::span<const ValueReference> references, std::span<const double> values) {
  require("fmi2SetReal", functions_->set_real, references.data(), references.size(), values.data());
}

void FmuSlave::set_integers(std::span<const ValueReference> references, std::span<const std::int32_t> values) {
  require("fmi2SetInteger", functions_->set_integer, references.data(), references.size(), values.data());
}

void FmuSlave::set_booleans(std::span<const ValueReference> references, std::span<const std::int32_t> values) {
  require("fmi2SetBoolean", functions_->set_boolean, references.data(), references.size(), values.data());
}

void FmuSlave::set_strings(std::span<const ValueReference> references, std::span<const std::string> values) {
  texts_.clear();
  for (const auto& value : values) texts_.push_back(value.c_str());
  require("fmi2SetString", functions_->set_string, references.data(), references.size(), texts_.data());
}

std::unique_ptr<SlaveState> FmuSlave::save_state() {
  if (!description().co_simulation->can_get_and_set_fmu_state || functions_->get_fmu_state == nullptr ||
      functions_->set_fmu_state == nullptr || functions_->free_fmu_state == nullptr) {
    throw Error(ErrorCode::not_offered,
                fmt::format("instance '{}': its FMU cannot save its state (canGetAndSetFMUstate is false)", name_));
  }
  auto state = std::make_unique<FmuSlaveState>(fmi_->freeing(*functions_), time_ns_, kept_states_);
  require("fmi2GetFMUstate", functions_->get_fmu_state, &state->state);
  return state;
}

void FmuSlave::restore_state(const SlaveState& state) {
  const auto& saved = static_cast<const FmuSlaveState&>(state);
  if (saved.time_ns < promised_ns_) {
    throw Error(
        ErrorCode::wrong_call_order,
        fmt::format("instance '{}': its state of {} s cannot be restored: at {} s no state was kept, so its FMU was "
                    "told that it will not be set back (noSetFMUStatePriorToCurrentPoint). Keep a state for as long as "
                    "the run may go back",
                    name_, to_seconds(saved.time_ns), to_seconds(promised_ns_)));
  }
  require("fmi2SetFMUstate", functions_->set_fmu_state, saved.state);
  time_ns_ = saved.time_ns;
}

std::vector<std::byte> FmuSlave::serialize(const SlaveState& state) {
  if (!description().co_simulation->can_serialize_fmu_state || functions_->serialize_fmu_state == nullptr ||
      functions_->serialized_fmu_state_size == nullptr) {
    throw Error(
        ErrorCode::not_offered,
        fmt::format("instance '{}': its FMU cannot write its state as bytes (canSerializeFMUstate is false)", name_));
  }
  const auto& saved = static_cast<const FmuSlaveState&>(state);
  std::size_t size = 0;
  require("fmi2SerializedFMUstateSize", functions_->serialized_fmu_state_size, saved.state, &size);
  constexpr std::size_t kLargestState = std::size_t{4} << 30;
  std::vector<std::byte> bytes;
  try {
    if (size > kLargestState) throw std::bad_alloc();
    bytes.resize(size);
  } catch (const std::bad_alloc&) {
    fail("fmi2SerializedFMUstateSize", fmt::format("reports a state of {} bytes, for which there is no memory", size));
  }
  require("fmi2SerializeFMUstate", functions_->serialize_fmu_state, saved.state,
          reinterpret_cast<fmi2Byte*>(bytes.data()), size);
  state::Writer writer;
  writer.put(saved.time_ns);
  writer.put(bytes);
  return writer.take();
}

std::unique_ptr<SlaveState> FmuSlave::deserialize(std::span<const std::byte> bytes) {
  if (!description().co_simulation->can_serialize_fmu_state || functions_->deserialize_fmu_state == nullptr) {
    throw Error(
        ErrorCode::not_offered,
        fmt::format("instance '{}': its FMU cannot read its state from bytes (canSerializeFMUstate is false)", name_));
  }
  state::Reader reader(bytes);
  auto state = std::make_unique<FmuSlaveState>(fmi_->freeing(*functions_), reader.get<std::int64_t>(), kept_states_);
  std::vector<std::byte> own;
  reader.get(own);
  require("fmi2DeSerializeFMUstate", functions_->deserialize_fmu_state, reinterpret_cast<const fmi2Byte*>(own.data()),
          own.size(), &state->state);
  return state;
}

}  // namespace mebots::master
