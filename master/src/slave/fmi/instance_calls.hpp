// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/time_grid.hpp"
#include "fmi/call/callbacks.hpp"
#include "fmi/call/foreign_call.hpp"
#include "fmi/fmu.hpp"
#include "message/message_hub.hpp"
#include "slave/slave.hpp"

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace mebots::master {

/// Calls an instance of an FMU, for all versions of FMI. Finds the instance to which a callback belongs, converts C++
/// exceptions to SlaveErrors, and adds names and times to messages. Keeps the floating-point environments of the master
/// and the FMU separate. Reports and reverts changes that the FMU makes to process-wide state. Must not be used by two
/// threads at the same time.
class InstanceCalls final : public CallbackListener {
 public:
  /// A function that returns the standard's name of a status.
  using StatusName = std::string_view (*)(int status);

  /// The status values, which are the same in all versions of FMI.
  static constexpr int kOk = 0;
  static constexpr int kWarning = 1;
  static constexpr int kDiscard = 2;
  static constexpr int kError = 3;
  static constexpr int kFatal = 4;
  static constexpr int kPending = 5;

  /// `messages` receives all warnings and errors, and those ordinary messages (status OK) whose category is in
  /// `log_categories`; "*" means all categories. `messages` must outlive this object. Points of `grid` are passed to
  /// the FMU as the nearest doubles.
  InstanceCalls(std::string name, std::shared_ptr<Fmu> fmu, std::vector<std::string> log_categories,
                MessageSink& messages, const TimeGrid& grid, StatusName status_name);
  ~InstanceCalls() override;
  InstanceCalls(const InstanceCalls&) = delete;
  InstanceCalls& operator=(const InstanceCalls&) = delete;

  const std::string& name() const { return name_; }
  Fmu& fmu() const { return *fmu_; }
  const modeldesc::ModelDescription& description() const { return fmu_->description(); }
  const TimeGrid& grid() const { return grid_; }
  MessageSink& messages() const { return *sink_; }
  /// Returns the object that provides the FMU's callbacks.
  CallbackTarget& target() { return target_; }
  bool usable() const { return !unusable_; }
  /// Prevents all further calls to the instance, including the call that frees it.
  void abandon() { unusable_ = true; }
  /// Returns the standard's name of a status.
  std::string_view name_of_status(int status) const { return status_name_(status); }

  /// Returns the simulated time that messages and errors contain [ns].
  std::int64_t time_ns() const { return time_ns_; }
  void set_time_ns(std::int64_t time_ns) { time_ns_ = time_ns; }

  /// Creates the instance by calling `make`, which must return null on failure. Before that, reports the process-wide
  /// changes that loading the FMU's library caused. Throws SlaveError if no instance is created.
  void instantiate(const char* function, const std::function<void*()>& make);
  /// Creates a new instance by calling `make`, after the caller has freed the previous one.
  void instantiate_again(const char* function, const std::function<void*()>& make);
  /// Frees the instance by calling `free`. A second call has no effect. If the FMU fails, logs the error and returns
  /// it.
  std::optional<std::string> free_instance(const char* function, const std::function<void()>& free);
  /// Sets the handler of fmi2StepFinished. A thread of the FMU may call the handler. Must be called before
  /// instantiate().
  void on_step_finished(std::function<void(int)> handler) { step_finished_ = std::move(handler); }
  /// Sets the handler of intermediate updates of FMI 3.0. The handler must not throw, and may use call_inside().
  void on_intermediate_update(std::function<void(double)> handler) { intermediate_update_ = std::move(handler); }
  /// Returns the categories that SetDebugLogging must enable. Returns an empty list if the FMU must log everything.
  std::vector<const char*> chosen_categories() const;

  /// Calls a function of the FMU, with the instance as its first argument, and returns the result. Throws SlaveError if
  /// the function throws a C++ exception.
  template <typename Function, typename... Arguments>
  [[gnu::always_inline]] auto call(const char* name, Function* function, Arguments... arguments) {
    return in_scope(name, [&] { return function(instance_, arguments...); });
  }
  /// Calls a function of the FMU from one of its callbacks, during call(). Does not catch exceptions of the FMU.
  template <typename Function, typename... Arguments>
  int call_inside(Function* function, Arguments... arguments) {
    return function(instance_, arguments...);
  }
  /// Calls a function as call() does. Throws SlaveError unless the returned status is OK or Warning.
  template <typename Function, typename... Arguments>
  [[gnu::always_inline]] void require(const char* name, Function* function, Arguments... arguments) {
    check(call(name, function, arguments...), name);
  }
  /// Throws SlaveError if the function is null, which means that the FMU's library lacks it.
  template <typename Function>
  void require_function(const char* name, Function* function) {
    if (function == nullptr) fail(name, "is missing in the FMU's library");
  }
  /// Runs `work`, which calls the FMU. Reports and reverts changes that these calls make to the process.
  template <typename Work>
  void watched(const char* where, Work work);
  /// Runs `work` as watched() does for the steps number 1, 2, 4, 8 ... of an instance, and without checks for all
  /// others, because checking every step would take too long.
  template <typename Work>
  [[gnu::always_inline]] int watched_step(const char* where, Work work);

  /// Copies the texts to which `function` has returned pointers for these String variables. A null pointer becomes an
  /// empty text. Throws SlaveError if an address is not readable.
  void copy_texts(const char* function, std::span<const std::uint32_t> references,
                  std::span<const char* const> addresses, std::span<std::string> values);

  /// Throws SlaveError unless the status is OK or Warning.
  void check(int status, const char* function);
  /// Throws SlaveError that contains instance, time, function, `what` and the FMU's log.
  [[noreturn]] void fail(const char* function, std::string_view what);
  /// Passes the held messages to the sink.
  void deliver_held();
  /// Logs a warning of the master about this instance.
  void warn(const std::string& text) { sink_->message({name_, Severity::warning, "notice", text, time_ns_}); }
  /// Runs `work` and drops its exceptions, such as an exception of the program that receives messages. Used by
  /// destructors.
  template <typename Work>
  static void without_exceptions(Work work) noexcept {
    try {
      work();
    } catch (...) {  // NOLINT(bugprone-empty-catch): see above
    }
  }
  /// Returns "The FMU logged: ..." followed by the last warnings and errors of the FMU.
  std::string last_messages() const;

  void logged(LoggerCall call) override;
  void step_finished(int status) override { step_finished_(status); }
  void intermediate_update(double time_s) noexcept override { intermediate_update_(time_s); }

 private:
  struct Held {
    Severity severity;
    std::string category;
    std::string text;
  };

  template <typename Work>
  [[gnu::always_inline]] auto in_scope(const char* name, Work work);
  [[noreturn, gnu::noinline]] void leave_by_exception(const char* name, const ForeignException& exception);
  void leave(const char* name);
  void report_floats(const FloatEnvironment& found, const char* where);
  void report_process_changes(const std::vector<std::string>& changes, const char* where);
  bool is_shown(Severity severity, std::string_view category) const;
  std::string with_names(std::string_view text) const;
  std::string string_name(std::uint32_t reference) const;
  void deliver_all_but(std::size_t last);

  std::string name_;
  std::shared_ptr<Fmu> fmu_;
  std::vector<std::string> log_categories_;
  MessageSink* sink_;
  TimeGrid grid_;
  StatusName status_name_;
  void* instance_ = nullptr;
  std::int64_t time_ns_ = 0;
  // True if no call is permitted, not even to free the instance: after a fatal status or an exception of the FMU, or if
  // a step does not end.
  bool unusable_ = false;
  bool is_watched_ = false;        // true if changes of the process by calls are reported and reverted
  bool freed_ = false;             // true after free_instance()
  bool is_gone_ = false;           // true if the FMU has freed the instance, so that none exists
  std::int64_t steps_ = 0;         // number of steps so far
  std::int64_t watched_step_ = 0;  // number of the next step that is checked; 0: none
  std::function<void(int)> step_finished_ = [](int) {};
  std::function<void(double)> intermediate_update_ = [](double) {};

  // FMUs may log from their own threads. Errors are held until the call returns, because the exception of a failed call
  // contains them. Messages from the FMU's threads are held too; the stepping thread delivers them.
  mutable std::mutex log_mutex_;
  std::vector<Held> held_;
  MessageLimit limit_;                 // counts since the start of the current call, or since the last call
  std::atomic<bool> any_held_{false};  // true if messages were held, or dropped by the limit
  std::deque<std::string> last_messages_;

  FloatEnvironment ours_ = FloatEnvironment::now();  // environment of the master's caller
  FloatEnvironment floats_;                          // environment of the instance
  CallbackTarget target_;  // declared last, because threads of the FMU may log until it is destroyed
};

template <typename Work>
[[gnu::always_inline]] inline auto InstanceCalls::in_scope(const char* name, Work work) {
  const CallbackScope scope(target_, name, time_ns_);
  if (floats_ != ours_) floats_.enter();
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

/// Stores the FMU's floating-point environment for its next call, and restores that of the master.
inline void InstanceCalls::leave(const char* name) {
  const auto found = FloatEnvironment::now();
  if (found != floats_) [[unlikely]] {
    report_floats(found, name);
    floats_ = found;
  }
  if (floats_ != ours_) ours_.enter();
}

template <typename Work>
void InstanceCalls::watched(const char* where, Work work) {
  const auto reach = fmu_->imports().reach;
  if (!is_watched_ || reach == ProcessReach::nothing) return work();
  static std::mutex one_at_a_time;
  const std::unique_lock lock(one_at_a_time, std::try_to_lock);
  if (!lock.owns_lock()) return work();  // does not wait: another thread's call may be waiting for this one
  const ProcessState before(fmu_->files_of_others(), reach);
  work();
  report_process_changes(before.put_right(), where);
}

template <typename Work>
[[gnu::always_inline]] inline int InstanceCalls::watched_step(const char* where, Work work) {
  if (++steps_ != watched_step_) [[likely]]
    return work();
  watched_step_ *= 2;
  int status = kOk;
  watched(where, [&] { status = work(); });
  return status;
}

}  // namespace mebots::master
