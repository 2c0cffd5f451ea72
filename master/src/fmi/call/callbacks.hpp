// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi1/types.hpp"
#include "mebots/fmi2/types.hpp"
#include "mebots/fmi3/types.hpp"

#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// The functions that an FMU calls. What it hands over is never believed: neither whose environment it says it has, nor
/// that its texts are texts.
namespace mebots::master {

/// One call of the logger, with texts made valid UTF-8.
struct LoggerCall {
  int status = fmi2OK;
  std::optional<std::string> instance;  ///< as the FMU named it; nothing for null and for what cannot be read
  std::string category;
  std::string text;
  bool own_environment = true;  ///< false: the FMU handed over another environment than it was given
  bool in_call = true;          ///< false: said by a thread of the FMU, and not within one of our calls
};

/// Hears what one instance says. Calls may come from threads of the FMU, also two at once.
class CallbackListener {
 public:
  virtual ~CallbackListener() = default;
  virtual void logged(LoggerCall call) = 0;
  virtual void step_finished(int status) = 0;
};

/// What fmi3Instantiate... takes.
struct Fmi3Callbacks {
  fmi3InstanceEnvironment environment = nullptr;
  fmi3LogMessageCallback log_message = nullptr;
};

/// A listener that callbacks find, as long as this lives. A callback belongs to the instance that this thread is in a
/// call of. On a thread of the FMU to the one whose environment it names, then to the one whose name it says, then to
/// the only one that there is. A callback that belongs to none is dropped.
class CallbackTarget {
 public:
  /// `listener` must outlive this object.
  CallbackTarget(CallbackListener& listener, std::string instance_name);
  /// Waits until callbacks that are under way on other threads are over.
  ~CallbackTarget();
  CallbackTarget(const CallbackTarget&) = delete;
  CallbackTarget& operator=(const CallbackTarget&) = delete;

  /// For fmiInstantiateSlave of FMI 1.0.
  static fmiCallbackFunctions fmi1_functions(bool asynchronous);
  /// For fmi2Instantiate; must not be used after this object is gone.
  fmi2CallbackFunctions functions(bool asynchronous);
  /// For fmi3Instantiate...; must not be used after this object is gone.
  Fmi3Callbacks fmi3_callbacks();

  CallbackListener& listener() const { return *listener_; }
  const std::string& instance_name() const { return instance_name_; }

 private:
  CallbackListener* listener_;
  std::string instance_name_;
};

/// A call to an FMU. The texts live as long as the call.
struct CurrentCall {
  const char* instance = nullptr;
  const char* function = nullptr;
  std::int64_t time_ns = 0;
  const char* library = nullptr;  ///< archive whose library is loaded or unloaded, for all of its instances
};

/// The call that this thread is in, for who is called out of it: signal handlers, exit(). Null instance and library: it
/// is in none. Safe in signal handlers.
CurrentCall current_call() noexcept;

/// The names of instances in this process, sorted; the first few of many. Nothing while one is being made or freed on
/// another thread, which is not waited for.
std::vector<std::string> instances_here();

void visit_instances(void* context, void (*visit)(void* context, const char* name));

/// Calls `work` with each instance's name, in no order; not for a registry that another thread changes just now. Safe
/// in signal handlers, as `work` is.
template <typename Work>
void for_each_instance(Work work) {
  visit_instances(&work, [](void* context, const char* name) { (*static_cast<Work*>(context))(name); });
}

/// The callback of ours that this thread is in.
struct CurrentCallback {
  const char* name = nullptr;  ///< null: none
  bool only_memory = false;    ///< it asks the C library for memory or gives some back: pointers are the FMU's word
};

/// What goes wrong in a callback is not the FMU's doing, but for memory that the FMU damaged. Safe in signal handlers.
CurrentCallback current_callback() noexcept;

/// From now on the logger hears nothing, in the whole process: where it failed, who did it shows without it.
void deafen_callbacks() noexcept;

/// Around every call to an instance: callbacks on this thread are its own.
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

/// Around loading and unloading an FMU's library, which run code of it that belongs to no instance.
class LibraryScope {
 public:
  /// `archive` and `function`, which says what is done, must outlive this object.
  LibraryScope(const char* archive, const char* function);
  ~LibraryScope();
  LibraryScope(const LibraryScope&) = delete;
  LibraryScope& operator=(const LibraryScope&) = delete;
};

}  // namespace mebots::master

/// Texts that foreign code hands to a callback. Nothing about them is believed: a pointer may lead nowhere, a format
/// may ask for arguments that are not there.
namespace mebots::master {

/// Longer texts are cut.
inline constexpr std::size_t kLongestText = std::size_t{64} * 1024;

/// The bytes from `address` up to a zero or `most`. Nothing for null and for memory that cannot be read: the kernel
/// copies, so that an address that leads nowhere is an answer and not a signal.
std::optional<std::string> read_text(const char* address, std::size_t most = kLongestText);

/// Returns false if a part of it cannot be read. Where the system does not say, true.
bool is_readable(std::span<const std::uint8_t> bytes);

/// As vsnprintf, for a format that may not fit its arguments. %n writes nothing, a %s that points nowhere becomes
/// "(unreadable)", widths and precisions are bounded. Arguments that are missing or of other types give wrong numbers,
/// which C cannot detect. After 100 conversions, or an unknown one, the rest is copied unchanged.
std::string format_text(const std::string& format, std::va_list arguments);

}  // namespace mebots::master
