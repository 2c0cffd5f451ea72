// SPDX-License-Identifier: Apache-2.0
#include "fmi/call/callbacks.hpp"

#include "fmi/call/forked_copies.hpp"
#include "message/message_text.hpp"

#include <dlfcn.h>
#include <link.h>

#include <algorithm>
#include <atomic>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <mutex>
#include <unordered_set>
#include <utility>

namespace mebots::master {
namespace {

constinit thread_local CallbackScope* current = nullptr;  // current call to an FMU on this thread
constinit thread_local CurrentCallback callback{};
// Loading or unloading of a library on this thread.
constinit thread_local CurrentCall of_library{};
constinit std::atomic<bool> callbacks_ignored{false};

class InCallback {
 public:
  explicit InCallback(CurrentCallback entered) : outer_(std::exchange(callback, entered)) {}
  ~InCallback() { callback = outer_; }
  InCallback(const InCallback&) = delete;
  InCallback& operator=(const InCallback&) = delete;

 private:
  CurrentCallback outer_;
};

/// All CallbackTargets. A callback on a thread that is not in a call to an FMU finds its target here.
struct Registry {
  std::mutex mutex;
  std::unordered_set<CallbackTarget*> targets;
  CallbackEnvironment* kept = nullptr;  // environments of instances that were not freed
};

Registry& registry() {
  static Registry& all = *new Registry;  // never destroyed, because a thread of an FMU may outlive main()
  return all;
}

/// Returns the only target for which the predicate is true; null if there are none or several.
template <typename Predicate>
CallbackTarget* find_only(const std::unordered_set<CallbackTarget*>& targets, Predicate predicate) {
  const auto found = std::ranges::find_if(targets, predicate);
  if (found == targets.end() || std::find_if(std::next(found), targets.end(), predicate) != targets.end())
    return nullptr;
  return *found;
}

bool is_kept(const Registry& all, const void* environment) {
  for (const auto* kept = all.kept; kept != nullptr; kept = kept->next_kept) {
    if (environment != nullptr && (kept == environment || kept->component == environment)) return true;
  }
  return false;
}

/// Finds the target of a callback. Compares the FMU's pointer, but does not dereference it.
CallbackTarget* find(const std::unordered_set<CallbackTarget*>& targets, const void* environment,
                     const std::optional<std::string>& name) {
  const auto has_environment = [&](const CallbackTarget* target) { return target->environment() == environment; };
  const auto has_component = [&](const CallbackTarget* target) { return target->component() == environment; };
  if (environment != nullptr) {
    if (auto* found = find_only(targets, has_environment)) return found;
    if (auto* found = find_only(targets, has_component)) return found;
  }
  const auto has_name = [&](const CallbackTarget* target) { return target->instance_name() == *name; };
  if (name) {
    if (auto* found = find_only(targets, has_name)) return found;
  }
  return targets.size() == 1 ? *targets.begin() : nullptr;
}

/// Calls `work` with the target of a callback. Returns false if the callback belongs to no instance. For an instance
/// that could not be freed, returns true without calling `work`.
template <typename Work>
bool with_target(const void* environment, const std::optional<std::string>& name, Work work) {
  if (current != nullptr) {
    work(current->target(), true);
    return true;
  }
  auto& all = registry();
  const std::lock_guard lock(all.mutex);  // prevents the destruction of the target during `work`
  if (is_kept(all, environment)) return true;
  auto* target = find(all.targets, environment, name);
  if (target != nullptr) work(*target, false);
  return target != nullptr;
}

std::optional<std::string> clean_text(const char* address) {
  auto text = read_text(address);
  if (text) text = valid_utf8(*text);
  return text;
}

std::string without_line_end(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  return text;
}

/// Delivers a message to its instance. Never throws. The message is lost if an error occurs.
void pass_on(LoggerCall call, const void* environment) noexcept {
  try {
    if (is_forked_copy()) {  // the files of the run belong to the original process
      std::fprintf(stderr, "mebots: a process that instance '%s' forked: %s\n", call.instance.value_or("?").c_str(),
                   one_line(call.text).c_str());
      return;
    }
    const auto instance = call.instance;
    with_target(environment, instance, [&](CallbackTarget& target, bool in_call) {
      call.own_environment = environment == target.environment();
      call.in_call = in_call;
      target.listener().logged(std::move(call));
    });
  } catch (...) {  // NOLINT(bugprone-empty-catch): see above
  }
}

/// Returns the text of a message, or a description of its error.
std::string message_text(const std::optional<std::string>& text, const char* address) {
  if (text) return without_line_end(valid_utf8(*text));
  return address == nullptr ? "(a message without a text)" : "(a message whose text cannot be read)";
}

/// Formats a message and delivers it to its instance. Never throws, because an FMU is the caller.
void log_formatted(LoggerCall call, const void* environment, const char* instance, const char* category,
                   const char* message, std::va_list arguments) noexcept {
  try {
    call.instance = clean_text(instance);
    call.category = clean_text(category).value_or("");
    auto text = read_text(message);
    if (text) text = format_text(*text, arguments);
    call.text = message_text(text, message);
    pass_on(std::move(call), environment);
  } catch (...) {  // NOLINT(bugprone-empty-catch): a message is lost, the simulation is not
  }
}

void log(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
         fmi2String message, ...) {
  if (callbacks_ignored.load(std::memory_order_relaxed)) return;
  const InCallback here({"logger", false});
  std::va_list arguments;
  va_start(arguments, message);
  LoggerCall call;
  call.status = status;
  log_formatted(std::move(call), environment, instance, category, message, arguments);
  va_end(arguments);
}

/// The logger of FMI 1.0, which receives no environment. On a thread of the FMU, the name identifies the instance.
void log_fmi1(fmiComponent /*component*/, fmiString instance, fmiStatus status, fmiString category, fmiString message,
              ...) {
  if (callbacks_ignored.load(std::memory_order_relaxed)) return;
  const InCallback here({"logger", false});
  std::va_list arguments;
  va_start(arguments, message);
  LoggerCall call;
  call.status = status;
  log_formatted(std::move(call), nullptr, instance, category, message, arguments);
  va_end(arguments);
}

void log_message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message) {
  if (callbacks_ignored.load(std::memory_order_relaxed)) return;
  const InCallback here({"logMessage", false});
  try {
    LoggerCall call;
    call.status = status;
    call.category = clean_text(category).value_or("");
    call.text = message_text(read_text(message), message);
    pass_on(std::move(call), environment);
  } catch (...) {  // NOLINT(bugprone-empty-catch): a message is lost, the simulation is not
  }
}

/// Handles an intermediate update without an early return. Ignores calls from threads of the FMU. The inputs then do
/// not change.
void intermediate_update(fmi3InstanceEnvironment /*environment*/, fmi3Float64 time_s, fmi3Boolean set_requested,
                         fmi3Boolean /*get_allowed*/, fmi3Boolean /*step_finished*/, fmi3Boolean /*can_return_early*/,
                         fmi3Boolean* early_return, fmi3Float64* early_return_s) {
  if (early_return != nullptr) *early_return = false;
  if (early_return_s != nullptr) *early_return_s = time_s;
  if (set_requested && current != nullptr) current->target().listener().intermediate_update(time_s);
}

/// Returns the loaded library that contains the code at this address; null if no library contains it.
const void* library_of(const void* code) {
  Dl_info info{};
  void* library = nullptr;
  return dladdr1(code, &info, &library, RTLD_DL_LINKMAP) != 0 ? library : nullptr;
}

/// Counts a call of stepFinished that belongs to no instance, for all instances whose library contains the caller. If
/// no library contains the caller, counts it for all instances.
void count_dropped_step_end(const void* caller) {
  const auto* library = library_of(caller);
  auto& all = registry();
  const std::lock_guard lock(all.mutex);
  const auto is_caller = [&](const CallbackTarget* target) { return target->library() == library; };
  const bool is_any = std::ranges::none_of(all.targets, is_caller);
  for (auto* target : all.targets) {
    if (is_any || is_caller(target)) target->count_dropped_step_end();
  }
}

/// Handles stepFinished. `caller` is the address of the calling code.
void end_step(const void* environment, int status, const void* caller) noexcept {
  const InCallback here({"stepFinished", false});
  try {
    const bool is_known = with_target(environment, std::nullopt, [&](CallbackTarget& target, bool /*in_call*/) {
      target.listener().step_finished(status);
    });
    if (!is_known) count_dropped_step_end(caller);
  } catch (...) {  // NOLINT(bugprone-empty-catch): the master calls fmi2GetStatus too
  }
}

void step_finished(fmi2ComponentEnvironment environment, fmi2Status status) {
  end_step(environment, status, __builtin_return_address(0));
}

/// stepFinished of FMI 1.0, which receives no environment. The component identifies the instance.
void step_finished_fmi1(fmiComponent component, fmiStatus status) {
  end_step(component, status, __builtin_return_address(0));
}

void* allocate_memory(std::size_t count, std::size_t size) {
  const InCallback here({"allocateMemory", true});
  return std::calloc(count, size);
}

void free_memory(void* memory) {
  const InCallback here({"freeMemory", true});
  std::free(memory);
}

}  // namespace

CallbackTarget::CallbackTarget(CallbackListener& listener, std::string instance_name)
    : listener_(&listener), instance_name_(std::move(instance_name)) {
  auto& all = registry();
  const std::lock_guard lock(all.mutex);
  all.targets.insert(this);
}

CallbackTarget::~CallbackTarget() {
  auto& all = registry();
  const std::lock_guard lock(all.mutex);
  all.targets.erase(this);
  if (!is_environment_kept_) return;
  environment_->component = component_;
  environment_->next_kept = all.kept;
  all.kept = environment_.release();
}

void CallbackTarget::set_component(const void* component) {
  const std::lock_guard lock(registry().mutex);
  component_ = component;
}

void CallbackTarget::set_library(const void* library) {
  const std::lock_guard lock(registry().mutex);
  library_ = library;
}

const fmi2CallbackFunctions& CallbackTarget::functions(bool asynchronous) {
  environment_->functions = {&log, &allocate_memory, &free_memory, asynchronous ? &step_finished : nullptr,
                             environment_.get()};
  return environment_->functions;
}

fmiCallbackFunctions CallbackTarget::fmi1_functions(bool asynchronous) {
  return {&log_fmi1, &allocate_memory, &free_memory, asynchronous ? &step_finished_fmi1 : nullptr};
}

Fmi3Callbacks CallbackTarget::fmi3_callbacks() {
  return {environment_.get(), &log_message, &intermediate_update};
}

CurrentCall current_call() noexcept {
  return current == nullptr ? of_library : current->call();
}

void visit_instances(void* context, void (*visit)(void* context, const char* name)) {
  auto& all = registry();
  const std::unique_lock lock(all.mutex, std::try_to_lock);
  if (!lock.owns_lock()) return;
  for (const auto* target : all.targets) visit(context, target->instance_name().c_str());
}

std::vector<std::string> instances_here() {
  constexpr std::size_t kShown = 8;
  std::vector<std::string> names;
  for_each_instance([&](const char* name) { names.emplace_back(name); });
  std::ranges::sort(names);
  if (names.size() > kShown) {
    names.resize(kShown);
    names.emplace_back("...");
  }
  return names;
}

CurrentCallback current_callback() noexcept {
  return callback;
}

void ignore_callbacks() noexcept {
  callbacks_ignored = true;
}

CallbackScope::CallbackScope(CallbackTarget& target, const char* function, std::int64_t time_ns)
    : target_(&target),
      call_{target.instance_name().c_str(), function, time_ns, nullptr},
      outer_(std::exchange(current, this)) {}

CallbackScope::~CallbackScope() {
  current = outer_;
}

LibraryScope::LibraryScope(const char* archive, const char* function) {
  of_library = {nullptr, function, 0, archive};
}

LibraryScope::~LibraryScope() {
  of_library = {};
}

}  // namespace mebots::master
