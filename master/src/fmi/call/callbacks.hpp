// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi1/types.hpp"
#include "mebots/fmi2/types.hpp"
#include "mebots/fmi3/types.hpp"

#include <atomic>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// Defines the functions that an FMU calls. They do not rely on valid arguments: the environment may be invalid, and a
/// pointer to a text may be invalid, too.
namespace mebots::master {

/// The arguments of one call of the logger. Texts are converted to valid UTF-8.
struct LoggerCall {
  int status = fmi2OK;
  /// Instance name that the FMU passed; nullopt if the pointer is null or unreadable.
  std::optional<std::string> instance;
  std::string category;
  std::string text;
  bool own_environment = true;  ///< false if the FMU passed another environment than it received
  bool in_call = true;          ///< false if a thread of the FMU called the logger outside of our calls
};

/// Receives the callbacks of one instance. Several threads of the FMU may call a listener at the same time.
class CallbackListener {
 public:
  virtual ~CallbackListener() = default;
  virtual void logged(LoggerCall call) = 0;
  virtual void step_finished(int status) = 0;
  /// Called by an FMU of FMI 3.0 within a step, when the FMU requests its inputs at `time_s`.
  virtual void intermediate_update(double /*time_s*/) noexcept {}
};

/// Contains the callbacks that fmi3Instantiate... receives.
struct Fmi3Callbacks {
  fmi3InstanceEnvironment environment = nullptr;
  fmi3LogMessageCallback log_message = nullptr;
  fmi3IntermediateUpdateCallback intermediate_update = nullptr;
};

/// The memory whose address an FMU receives as the environment of its callbacks. The address identifies the instance.
struct CallbackEnvironment {
  fmi2CallbackFunctions functions{};
  // Set after keep_environment(); FMI 1.0 passes the component in place of the environment.
  const void* component = nullptr;
  CallbackEnvironment* next_kept = nullptr;
};

/// Registers a listener for the callbacks of one instance during its lifetime. A callback within a call to an instance
/// belongs to this instance. A callback on a thread of the FMU belongs to the instance whose environment (FMI 1.0:
/// component) the FMU passes. If no instance has this environment, the passed name identifies the instance. If the name
/// is unknown and only one instance exists, the callback belongs to this instance. All other callbacks are dropped, and
/// also those of instances that could not be freed.
class CallbackTarget {
 public:
  /// `listener` must outlive this object.
  CallbackTarget(CallbackListener& listener, std::string instance_name);
  /// Waits for callbacks that are running on other threads.
  ~CallbackTarget();
  CallbackTarget(const CallbackTarget&) = delete;
  CallbackTarget& operator=(const CallbackTarget&) = delete;

  /// Returns the callbacks that fmiInstantiateSlave of FMI 1.0 receives.
  static fmiCallbackFunctions fmi1_functions(bool asynchronous);
  /// Returns the callbacks that fmi2Instantiate receives. They are valid as long as this object exists; after
  /// keep_environment(), until the process ends.
  const fmi2CallbackFunctions& functions(bool asynchronous);
  /// Returns the callbacks that fmi3Instantiate... receives. They are valid as long as the result of functions().
  Fmi3Callbacks fmi3_callbacks();
  /// Keeps the environment until the process ends. Needed if an instance is not freed, because its threads may use the
  /// environment.
  void keep_environment() { is_environment_kept_ = true; }
  /// Sets the loaded library of the FMU. `library` points to a `link_map`.
  void set_library(const void* library);
  /// Returns the number of stepFinished calls that were dropped because they belonged to no known instance. Counts
  /// calls from this target's library and from unknown libraries.
  std::uint64_t dropped_step_ends() const { return dropped_step_ends_; }

  /// Sets the component that the instantiating function of the FMU returned. Callbacks of FMI 1.0 pass this component,
  /// because FMI 1.0 has no environment.
  void set_component(const void* component);

  CallbackListener& listener() const { return *listener_; }
  const std::string& instance_name() const { return instance_name_; }
  const void* environment() const { return environment_.get(); }

  // The caller of the following functions must hold the registry's mutex.
  const void* component() const { return component_; }
  const void* library() const { return library_; }
  void count_dropped_step_end() { ++dropped_step_ends_; }

 private:
  CallbackListener* listener_;
  std::string instance_name_;
  const void* component_ = nullptr;
  const void* library_ = nullptr;
  std::unique_ptr<CallbackEnvironment> environment_ = std::make_unique<CallbackEnvironment>();
  bool is_environment_kept_ = false;
  std::atomic<std::uint64_t> dropped_step_ends_{0};
};

/// Describes a call to an FMU that has not returned yet. The texts are valid during the call.
struct CurrentCall {
  const char* instance = nullptr;
  const char* function = nullptr;
  std::int64_t time_ns = 0;
  /// Archive whose library is being loaded or unloaded; null during a call to an instance.
  const char* library = nullptr;
};

/// Returns the call to an FMU that this thread is executing. If the thread is in no such call, `instance` and `library`
/// are null. May be called in signal handlers and by exit handlers.
CurrentCall current_call() noexcept;

/// Returns the sorted names of the instances in this process; if there are many, only the first few. If another thread
/// is creating or freeing an instance, returns an empty list without waiting.
std::vector<std::string> instances_here();

void visit_instances(void* context, void (*visit)(void* context, const char* name));

/// Calls `work` with the name of each instance, in no particular order. If another thread is changing the registry,
/// does not call `work`. May be called in signal handlers if `work` permits it.
template <typename Work>
void for_each_instance(Work work) {
  visit_instances(&work, [](void* context, const char* name) { (*static_cast<Work*>(context))(name); });
}

/// Describes the callback of mebots that this thread is executing.
struct CurrentCallback {
  const char* name = nullptr;  ///< name of the callback; null if no callback is running
  bool only_memory = false;    ///< true if the callback only allocates or frees memory, with pointers from the FMU
};

/// Returns the callback that this thread is executing. A crash in a callback is a fault of mebots, unless the FMU has
/// damaged memory. May be called in signal handlers.
CurrentCallback current_callback() noexcept;

/// Makes all logger callbacks of the process ignore their messages. `mebots check` repeats an experiment in this way
/// after a crash in a callback, to find out whether the FMU or mebots caused the crash.
void ignore_callbacks() noexcept;

/// Must exist during every call to an instance. While it exists, callbacks on this thread belong to the instance.
class CallbackScope {
 public:
  /// `function` must outlive this object.
  CallbackScope(CallbackTarget& target, const char* function, std::int64_t time_ns);
  ~CallbackScope();
  CallbackScope(const CallbackScope&) = delete;
  CallbackScope& operator=(const CallbackScope&) = delete;

  CallbackTarget& target() const { return *target_; }
  const CurrentCall& call() const { return call_; }

 private:
  CallbackTarget* target_;
  CurrentCall call_;
  CallbackScope* outer_;
};

/// Must exist while an FMU's library is loaded or unloaded, because both run code of the library outside of any
/// instance.
class LibraryScope {
 public:
  /// `archive` and `function`, which describes the operation, must outlive this object.
  LibraryScope(const char* archive, const char* function);
  ~LibraryScope();
  LibraryScope(const LibraryScope&) = delete;
  LibraryScope& operator=(const LibraryScope&) = delete;
};

}  // namespace mebots::master

/// Reads texts that foreign code passes to a callback. A pointer to a text may be invalid, and a format may require
/// arguments that are missing.
namespace mebots::master {

/// Longest text in bytes. Longer texts are truncated.
inline constexpr std::size_t kLongestText = std::size_t{64} * 1024;

/// Returns the bytes from `address` up to a zero byte, at most `most` bytes. Returns nullopt if the address is null or
/// unreadable. The kernel copies the bytes, so that an invalid address causes an error code instead of a signal.
std::optional<std::string> read_text(const char* address, std::size_t most = kLongestText);

/// Returns false if one of the bytes cannot be read. If the system forbids this check, returns true.
bool is_readable(std::span<const std::uint8_t> bytes);

/// Formats like vsnprintf, but tolerates a format that does not match its arguments. A %n writes nothing, a %s with an
/// invalid pointer becomes "(unreadable)", and widths and precisions are limited. If arguments are missing or have
/// other types, the text contains wrong numbers, because C cannot detect this. After 100 conversions, or after an
/// unknown conversion, copies the rest of the format unchanged.
std::string format_text(const std::string& format, std::va_list arguments);

}  // namespace mebots::master
