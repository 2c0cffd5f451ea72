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

/// Defines the functions that an FMU calls. The FMU may pass an invalid environment or invalid pointers.
namespace mebots::master {

/// The arguments of a call to the logger. Texts are converted to valid UTF-8.
struct LoggerCall {
  int status = fmi2OK;
  /// Instance name that the FMU passed; nullopt if its pointer is null or unreadable.
  std::optional<std::string> instance;
  std::string category;
  std::string text;
  bool own_environment = true;  ///< false if the FMU passed another environment than that of its instance
  bool in_call = true;          ///< false if a thread of the FMU called the logger outside of a call to the FMU
};

/// Receives the callbacks of one instance. Several threads of the FMU may call its functions at the same time.
class CallbackListener {
 public:
  virtual ~CallbackListener() = default;
  virtual void logged(LoggerCall call) = 0;
  virtual void step_finished(int status) = 0;
  /// Called within a step if an FMU of FMI 3.0 requests its inputs at `time_s`.
  virtual void intermediate_update(double /*time_s*/) noexcept {}
};

/// The callbacks for fmi3InstantiateCoSimulation and fmi3InstantiateModelExchange.
struct Fmi3Callbacks {
  fmi3InstanceEnvironment environment = nullptr;
  fmi3LogMessageCallback log_message = nullptr;
  fmi3IntermediateUpdateCallback intermediate_update = nullptr;
};

/// The environment that an FMU passes to the callbacks of the master. Its address identifies the instance.
struct CallbackEnvironment {
  fmi2CallbackFunctions functions{};
  // The component of an instance of FMI 1.0, which has no environment. Set after keep_environment().
  const void* component = nullptr;
  CallbackEnvironment* next_kept = nullptr;
};

/// Registers a listener for the callbacks of one instance. A callback during a call to an instance belongs to this
/// instance. A callback from a thread of the FMU belongs to the instance whose environment the FMU passes (FMI 1.0:
/// whose component). If the environment is unknown, the instance name identifies the instance. If the name is also
/// unknown and there is only one instance, the callback belongs to it. All other callbacks are dropped, also those of
/// instances that could not be freed.
class CallbackTarget {
 public:
  /// `listener` must outlive this object.
  CallbackTarget(CallbackListener& listener, std::string instance_name);
  /// Waits for callbacks that are running on other threads.
  ~CallbackTarget();
  CallbackTarget(const CallbackTarget&) = delete;
  CallbackTarget& operator=(const CallbackTarget&) = delete;

  static fmiCallbackFunctions fmi1_functions(bool asynchronous);
  /// Returns the callbacks for FMI 2.0. They are valid as long as this object exists or, after keep_environment(),
  /// until the process ends.
  const fmi2CallbackFunctions& functions(bool asynchronous);
  /// Returns the callbacks for FMI 3.0. They are valid as long as those for FMI 2.0 (see functions()).
  Fmi3Callbacks fmi3_callbacks();
  /// Keeps the environment until the process ends. Must be called if the instance is not freed, because its threads may
  /// still use the environment.
  void keep_environment() { is_environment_kept_ = true; }
  /// Sets the loaded library of the FMU, which must be a `link_map`.
  void set_library(const void* library);
  /// Returns the number of dropped calls to stepFinished, which belonged to no instance. Includes only calls from this
  /// FMU's library and from unknown libraries.
  std::uint64_t dropped_step_ends() const { return dropped_step_ends_; }

  /// Sets the component that the FMU returned. FMI 1.0 passes it to callbacks in place of an environment.
  void set_component(const void* component);

  CallbackListener& listener() const { return *listener_; }
  const std::string& instance_name() const { return instance_name_; }
  const void* environment() const { return environment_.get(); }

  // The caller of the following functions must hold the mutex of the registry.
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

/// A call to an FMU that has not returned. The texts are valid during the call.
struct CurrentCall {
  const char* instance = nullptr;
  const char* function = nullptr;
  std::int64_t time_ns = 0;
  /// Archive whose library is being loaded or unloaded; null during a call to an instance.
  const char* library = nullptr;
};

/// Returns the current call of this thread to an FMU. Outside of calls, `instance` and `library` are null. Safe in
/// signal handlers and exit handlers.
CurrentCall current_call() noexcept;

/// Returns the sorted names of the instances in this process, or of the first few if there are many. Returns an empty
/// list if another thread is creating or freeing an instance.
std::vector<std::string> instances_here();

void visit_instances(void* context, void (*visit)(void* context, const char* name));

/// Calls `work` with the name of each instance, in any order. Calls nothing if another thread is changing the registry.
/// Safe in signal handlers if `work` is.
template <typename Work>
void for_each_instance(Work work) {
  visit_instances(&work, [](void* context, const char* name) { (*static_cast<Work*>(context))(name); });
}

struct CurrentCallback {
  const char* name = nullptr;  ///< null if no callback is running
  bool only_memory = false;    ///< true if the callback only allocates or frees memory
};

/// Returns the current callback of this thread. A crash in a callback is a fault of mebots, unless the FMU has damaged
/// memory. Safe in signal handlers.
CurrentCallback current_callback() noexcept;

/// Makes the logger callbacks of all instances ignore their messages. If a callback crashes, `mebots check` repeats the
/// experiment in this mode to find out whether the FMU or mebots is at fault.
void ignore_callbacks() noexcept;

/// Marks a call to an instance. Callbacks on this thread belong to the instance while this object exists.
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

/// Must exist while the library of an FMU is loaded or unloaded, because both run code of the library.
class LibraryScope {
 public:
  /// `archive` and `function` must outlive this object. `function` describes the operation.
  LibraryScope(const char* archive, const char* function);
  ~LibraryScope();
  LibraryScope(const LibraryScope&) = delete;
  LibraryScope& operator=(const LibraryScope&) = delete;
};

}  // namespace mebots::master

/// Reads texts from pointers that an FMU passes to callbacks. The pointers may be invalid, and arguments of a format
/// may be missing.
namespace mebots::master {

/// The maximum size of a text in bytes. Longer texts are truncated.
inline constexpr std::size_t kLongestText = std::size_t{64} * 1024;

/// Copies the text at `address` up to its zero byte, at most `most` bytes. Returns nullopt if the address is null or
/// unreadable. Uses a system call, which returns an error instead of raising a signal.
std::optional<std::string> read_text(const char* address, std::size_t most = kLongestText);

/// True if all bytes can be read, or if the system does not permit this check.
bool is_readable(std::span<const std::uint8_t> bytes);

/// Formats like vsnprintf, but tolerates a format that does not match its arguments. %n writes nothing. %s with an
/// invalid pointer becomes "(unreadable)". Widths and precisions are limited. Missing arguments and wrong types cause
/// wrong numbers, because C cannot detect them. The format is copied unchanged after 100 conversions or after an
/// unknown conversion.
std::string format_text(const std::string& format, std::va_list arguments);

}  // namespace mebots::master
