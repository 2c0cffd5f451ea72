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

/// The functions that an FMU calls. These functions trust no argument: the environment may be invalid, and a text may
/// be no text.
namespace mebots::master {

/// The arguments of a call of the logger, with texts converted to valid UTF-8.
struct LoggerCall {
  int status = fmi2OK;
  std::optional<std::string> instance;  ///< as named by the FMU; empty if null or unreadable
  std::string category;
  std::string text;
  bool own_environment = true;  ///< false: the FMU passed a different environment from the one it was given
  bool in_call = true;          ///< false: logged by a thread of the FMU outside of our calls
};

/// Receives the messages of one instance. Several threads of the FMU may call a listener at the same time.
class CallbackListener {
 public:
  virtual ~CallbackListener() = default;
  virtual void logged(LoggerCall call) = 0;
  virtual void step_finished(int status) = 0;
  /// Called by an FMU (FMI 3.0) within a step. The FMU requests its inputs at `time_s`.
  virtual void intermediate_update(double /*time_s*/) noexcept {}
};

/// The callbacks for fmi3Instantiate...
struct Fmi3Callbacks {
  fmi3InstanceEnvironment environment = nullptr;
  fmi3LogMessageCallback log_message = nullptr;
  fmi3IntermediateUpdateCallback intermediate_update = nullptr;
};

/// The memory that is passed to an FMU as the environment of its callbacks. Its address identifies the instance.
struct CallbackEnvironment {
  fmi2CallbackFunctions functions{};
  const void* component = nullptr;  // of a kept one: FMI 1.0 passes it in place of the environment
  CallbackEnvironment* next_kept = nullptr;
};

/// Registers a listener for callbacks during its lifetime. A callback within a call to an instance belongs to this
/// instance. A callback on a thread of the FMU belongs to the instance with the passed environment (FMI 1.0:
/// component). If no instance has this environment, the passed name identifies the instance. If the name is unknown and
/// only one instance exists, the callback belongs to it. All other callbacks are dropped. Callbacks of instances that
/// could not be freed are dropped, too.
class CallbackTarget {
 public:
  /// `listener` must outlive this object.
  CallbackTarget(CallbackListener& listener, std::string instance_name);
  /// The destructor waits for callbacks that run on other threads.
  ~CallbackTarget();
  CallbackTarget(const CallbackTarget&) = delete;
  CallbackTarget& operator=(const CallbackTarget&) = delete;

  /// Returns the callbacks for fmiInstantiateSlave of FMI 1.0.
  static fmiCallbackFunctions fmi1_functions(bool asynchronous);
  /// Returns the callbacks for fmi2Instantiate. The callbacks are valid as long as this object. After
  /// keep_environment(), they are valid until the process ends.
  const fmi2CallbackFunctions& functions(bool asynchronous);
  /// Returns the callbacks for fmi3Instantiate... These callbacks are valid as long as the result of functions().
  Fmi3Callbacks fmi3_callbacks();
  /// Keeps the environment until the process ends, because threads of an instance that is not freed may use it.
  void keep_environment() { is_environment_kept_ = true; }
  /// Sets the FMU's loaded library, a `link_map`.
  void set_library(const void* library);
  /// Returns how many calls of stepFinished from this target's library, or from unknown libraries, belonged to no known
  /// instance.
  std::uint64_t dropped_step_ends() const { return dropped_step_ends_; }

  /// Sets the component that the FMU's instantiating function returned. Callbacks of FMI 1.0 pass the component,
  /// because they have no environment.
  void set_component(const void* component);

  CallbackListener& listener() const { return *listener_; }
  const std::string& instance_name() const { return instance_name_; }
  const void* environment() const { return environment_.get(); }

  // The caller of these functions must hold the registry's mutex.
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
  const char* library = nullptr;  ///< archive whose library is being loaded or unloaded, for all of its instances
};

/// Returns the call to an FMU that this thread is making, for signal handlers and exit(). If there is none, instance
/// and library are null. Safe in signal handlers.
CurrentCall current_call() noexcept;

/// Returns the sorted names of instances in this process. If there are many, returns only the first few. If another
/// thread is creating or freeing an instance, does not wait and returns an empty list.
std::vector<std::string> instances_here();

void visit_instances(void* context, void (*visit)(void* context, const char* name));

/// Calls `work` with each instance's name, in no order. Skips the registry if another thread is changing it. Safe in
/// signal handlers if `work` is.
template <typename Work>
void for_each_instance(Work work) {
  visit_instances(&work, [](void* context, const char* name) { (*static_cast<Work*>(context))(name); });
}

/// The callback of mebots that this thread is executing.
struct CurrentCallback {
  const char* name = nullptr;  ///< null: none
  bool only_memory = false;    ///< it allocates or frees memory by the C library, with pointers from the FMU
};

/// Returns the callback that this thread is executing. An error in a callback is a fault of mebots, unless the FMU has
/// damaged memory. Safe in signal handlers.
CurrentCallback current_callback() noexcept;

/// Makes all logger callbacks of the process ignore their messages. After a crash in a callback, `mebots check` repeats
/// the experiment in this way, to find out whether the FMU or mebots caused the crash.
void ignore_callbacks() noexcept;

/// Encloses every call to an instance. Callbacks on this thread belong to the instance while the scope exists.
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

/// Encloses the loading and unloading of an FMU's library. Both run code of the library outside of any instance.
class LibraryScope {
 public:
  /// `archive` and `function`, which describes the operation, must outlive this object.
  LibraryScope(const char* archive, const char* function);
  ~LibraryScope();
  LibraryScope(const LibraryScope&) = delete;
  LibraryScope& operator=(const LibraryScope&) = delete;
};

}  // namespace mebots::master

/// Texts that foreign code passes to a callback. mebots does not trust these texts: a pointer may be invalid, and a
/// format may need arguments that are missing.
namespace mebots::master {

/// Longer texts are truncated.
inline constexpr std::size_t kLongestText = std::size_t{64} * 1024;

/// Returns the bytes from `address` up to a zero byte or `most`. Returns empty for null and for unreadable memory. The
/// kernel copies the bytes, so an invalid address causes an error code and no signal.
std::optional<std::string> read_text(const char* address, std::size_t most = kLongestText);

/// Returns false if any of the bytes cannot be read. If the system forbids the check, returns true.
bool is_readable(std::span<const std::uint8_t> bytes);

/// Formats like vsnprintf, but tolerates a format that does not fit its arguments. %n writes nothing, a %s with an
/// invalid pointer becomes "(unreadable)", widths and precisions are bounded. If arguments are missing or have other
/// types, the text contains wrong numbers, because C cannot detect this. After 100 conversions, or after an unknown
/// conversion, the rest of the format is copied unchanged.
std::string format_text(const std::string& format, std::va_list arguments);

}  // namespace mebots::master
