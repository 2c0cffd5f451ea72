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

/// Calls the functions of an FMU instance, for all versions of FMI. Converts C++ exceptions of the FMU to SlaveError,
/// and adds instance names and times to its messages. Separates the floating-point environments of the master and the
/// FMU. Reports and reverts changes of process-wide state. Must not be used by two threads at the same time.
class InstanceCalls final : public CallbackListener {
 public:
  /// Returns the name of a status in the FMI standard.
  using StatusName = std::string_view (*)(int status);

  /// Status values, which are the same in all versions of FMI.
  static constexpr int kOk = 0;
  static constexpr int kWarning = 1;
  static constexpr int kDiscard = 2;
  static constexpr int kError = 3;
  static constexpr int kFatal = 4;
  static constexpr int kPending = 5;

  /// `messages` receives all warnings and errors. It receives ordinary messages (status OK) only if `log_categories`
  /// contains their category or "*". `messages` must outlive this object. The FMU receives the points of `grid` as the
  /// nearest doubles.
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
  /// Returns the receiver of the FMU's callbacks.
  CallbackTarget& target() { return target_; }
  bool usable() const { return !unusable_; }
  /// Prevents all further calls to the instance. The instance is then never freed.
  void abandon() { unusable_ = true; }
  std::string_view name_of_status(int status) const { return status_name_(status); }

  /// Returns the simulated time for messages and errors.
  std::int64_t time_ns() const { return time_ns_; }
  void set_time_ns(std::int64_t time_ns) { time_ns_ = time_ns; }

  /// Creates the instance by calling `make`. Before that, reports the process-wide changes that the loading of the
  /// FMU's library has caused. Throws SlaveError if `make` returns null.
  void instantiate(const char* function, const std::function<void*()>& make);
  /// Creates another instance by calling `make`. The caller must have freed the previous instance.
  void instantiate_again(const char* function, const std::function<void*()>& make);
  /// Frees the instance by calling `free`. If the FMU fails, logs the error and returns it. Further calls have no
  /// effect.
  std::optional<std::string> free_instance(const char* function, const std::function<void()>& free);
  /// Sets the handler of the callback fmi2StepFinished. A thread of the FMU may call the handler. Must be called before
  /// instantiate().
  void on_step_finished(std::function<void(int)> handler) { step_finished_ = std::move(handler); }
  /// Sets the handler of the callback intermediateUpdate of FMI 3.0. The handler must not throw. It may use
  /// call_inside().
  void on_intermediate_update(std::function<void(double)> handler) { intermediate_update_ = std::move(handler); }
  /// Returns the log categories that the FMU must enable; an empty list if it must log everything.
  std::vector<const char*> chosen_categories() const;

  /// Calls a function of the FMU and returns its result. The instance is the first argument. Throws SlaveError if the
  /// function throws a C++ exception.
  template <typename Function, typename... Arguments>
  [[gnu::always_inline]] auto call(const char* name, Function* function, Arguments... arguments) {
    return in_scope(name, [&] { return function(instance_, arguments...); });
  }
  /// Calls a function of the FMU from a callback. Does not catch exceptions of the FMU.
  template <typename Function, typename... Arguments>
  int call_inside(Function* function, Arguments... arguments) {
    return function(instance_, arguments...);
  }
  /// Calls a function like call(). Throws SlaveError if the status is neither OK nor Warning.
  template <typename Function, typename... Arguments>
  [[gnu::always_inline]] void require(const char* name, Function* function, Arguments... arguments) {
    check(call(name, function, arguments...), name);
  }
  /// Throws SlaveError if `function` is null, because the FMU's library lacks it.
  template <typename Function>
  void require_function(const char* name, Function* function) {
    if (function == nullptr) fail(name, "is missing in the FMU's library");
  }
  /// Runs `work`, which calls the FMU. Reports and reverts process-wide changes of these calls.
  template <typename Work>
  void watched(const char* where, Work work);
  /// Runs `work`, which performs a step. Checks for process-wide changes only in the steps 1, 2, 4, 8 and so on,
  /// because the checks are slow.
  template <typename Work>
  [[gnu::always_inline]] int watched_step(const char* where, Work work);

  /// Copies the String values at the addresses that `function` returned. A null pointer becomes an empty text. Throws
  /// SlaveError if an address is not readable.
  void copy_texts(const char* function, std::span<const std::uint32_t> references,
                  std::span<const char* const> addresses, std::span<std::string> values);

  /// Throws SlaveError if the status is neither OK nor Warning.
  void check(int status, const char* function);
  /// Throws SlaveError with the instance, time, function, `what` and the FMU's log.
  [[noreturn]] void fail(const char* function, std::string_view what);
  /// Delivers the stored messages to the message sink.
  void deliver_held();
  void warn(const std::string& text) { sink_->message({name_, Severity::warning, "notice", text, time_ns_}); }
  /// Runs `work` and ignores its exceptions, for example those of a message listener. For use in destructors.
  template <typename Work>
  static void without_exceptions(Work work) noexcept {
    try {
      work();
    } catch (...) {  // NOLINT(bugprone-empty-catch): see above
    }
  }
  /// Returns "The FMU logged: ..." with the last warnings and errors of the FMU.
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
  // True if the instance must not be called or freed: after a fatal status, an exception of the FMU, or a step that
  // does not end.
  bool unusable_ = false;
  bool is_watched_ = false;  // true: process-wide changes are reported and reverted
  bool freed_ = false;
  bool is_gone_ = false;  // true after the FMU has freed the instance without an error
  std::int64_t steps_ = 0;
  std::int64_t watched_step_ = 0;  // number of the next step that is checked; 0: no step is checked
  std::function<void(int)> step_finished_ = [](int) {};
  std::function<void(double)> intermediate_update_ = [](double) {};

  // FMUs may log from their own threads. Such messages are stored, and the stepping thread delivers them. Errors are
  // stored until the call returns, because the exception of a failed call contains them.
  mutable std::mutex log_mutex_;
  std::vector<Held> held_;
  MessageLimit limit_;                 // counts messages since the start or the end of the last call
  std::atomic<bool> any_held_{false};  // true if messages were stored or dropped
  std::deque<std::string> last_messages_;

  FloatEnvironment ours_ = FloatEnvironment::now();  // floating-point environment of the master's caller
  FloatEnvironment floats_;                          // floating-point environment of the instance
  CallbackTarget target_;  // must be destroyed first, because threads of the FMU may log until then
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
  if (!lock.owns_lock()) return work();  // no waiting: another thread may call the FMU and wait for this thread
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
