// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/time_grid.hpp"
#include "fmi/fmu.hpp"
#include "message/message_hub.hpp"
#include "slave/slave.hpp"

#include <atomic>
#include <condition_variable>
#include <deque>
#include <limits>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace mebots::master {

/// A slave that runs inside this process: calls go straight into the FMU's shared library.
class FmuSlave final : public Slave {
 public:
  /// Instantiates. `log_categories` are the categories whose ordinary messages (fmi2OK) go to `messages`,
  /// "*" for all; warnings and errors always go there. `messages` must outlive the slave. Points of `grid` are passed
  /// to the FMU as the nearest doubles.
  FmuSlave(std::string name, std::shared_ptr<Fmu> fmu, std::vector<std::string> log_categories, MessageSink& messages,
           const TimeGrid& grid = {});
  ~FmuSlave() override;
  FmuSlave(const FmuSlave&) = delete;
  FmuSlave& operator=(const FmuSlave&) = delete;

  const std::string& name() const override { return name_; }
  const modeldesc::ModelDescription& description() const override { return fmu_->description(); }

  void setup_experiment(const Experiment& experiment) override;
  void enter_initialization() override;
  void exit_initialization() override;
  StepResult step(std::int64_t start_ns, std::int64_t duration_ns) override;
  StepResult finish_step(const std::atomic<bool>& cancel) override;
  void terminate() override;
  std::optional<std::string> free_instance() override;

  std::uint32_t output_derivative_order() const override;
  bool takes_input_derivatives() const override;
  void get_output_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                              std::span<double> values) override;
  void set_input_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                             std::span<const double> values) override;

  void get_reals(std::span<const ValueReference> references, std::span<double> values) override;
  void get_integers(std::span<const ValueReference> references, std::span<std::int32_t> values) override;
  void get_booleans(std::span<const ValueReference> references, std::span<std::int32_t> values) override;
  void get_strings(std::span<const ValueReference> references, std::span<std::string> values) override;
  void set_reals(std::span<const ValueReference> references, std::span<const double> values) override;
  void set_integers(std::span<const ValueReference> references, std::span<const std::int32_t> values) override;
  void set_booleans(std::span<const ValueReference> references, std::span<const std::int32_t> values) override;
  void set_strings(std::span<const ValueReference> references, std::span<const std::string> values) override;

  std::unique_ptr<SlaveState> save_state() override;
  void restore_state(const SlaveState& state) override;
  std::vector<std::byte> serialize(const SlaveState& state) override;
  std::unique_ptr<SlaveState> deserialize(std::span<const std::byte> bytes) override;

 private:
  struct Fmi;  // what needs FMI's C types

  void tell_of_process(const std::vector<std::string>& changes, const char* where);
  template <typename Work>
  void watched(const char* where, Work work);
  void tell_of_floats(const FloatEnvironment& found, const char* where);
  void choose_categories();
  void logged(int status, std::string_view category, std::string text, bool in_call);
  std::string with_names(std::string_view text) const;
  void check(int status, const char* function);
  template <typename Function, typename... Arguments>
  void require(const char* name, Function* function, Arguments... arguments);
  StepResult step_ended(int status);
  void step_finished(int status);
  int do_step(std::int64_t start_ns, std::int64_t duration_ns, bool never_back);
  int wait_for_step(const std::atomic<bool>& cancel);
  void deliver_held();
  void deliver_but(std::size_t last);
  std::string string_name(ValueReference reference) const;
  std::string said() const;
  [[noreturn]] void fail(const char* function, std::string_view what);

  std::string name_;
  std::shared_ptr<Fmu> fmu_;
  std::vector<std::string> log_categories_;
  MessageSink* sink_;
  TimeGrid grid_;
  const Fmi2Functions* functions_;

  std::int64_t time_ns_ = 0;
  std::int64_t step_end_ns_ = 0;
  bool unusable_ = false;          // after fmi2Fatal no call is allowed, not even freeing
  bool is_watched_ = false;        // what it changes in the process is told and put right
  std::int64_t steps_ = 0;         // called so far
  std::int64_t watched_step_ = 0;  // the next one that is watched; 0: none
  bool pending_ = false;           // a step goes on by itself
  bool freed_ = false;
  // noSetFMUStatePriorToCurrentPoint: an FMU that hears it may drop what it would need to go back.
  int kept_states_ = 0;                                                  // how many there are to go back to
  std::int64_t promised_ns_ = std::numeric_limits<std::int64_t>::min();  // never back behind this time
  std::vector<const char*> texts_;

  // An asynchronous FMU tells from a thread of its own that its step is over.
  std::mutex step_mutex_;
  std::condition_variable step_over_;
  std::optional<int> step_status_;

  // The FMU may log from threads of its own.
  std::mutex log_mutex_;
  // Errors are held until the call is over: a call that fails carries them in its exception. So is what threads of the
  // FMU say: it is handed on by the thread that steps.
  struct Held {
    Severity severity;
    std::string category;
    std::string text;
  };
  std::vector<Held> held_;
  MessageLimit limit_;                 // of the call, or since the last one
  std::atomic<bool> any_held_{false};  // or was said since the limit began anew
  std::deque<std::string> last_words_;

  std::unique_ptr<Fmi> fmi_;  // last: threads of the FMU find what they log to until it is gone
};

}  // namespace mebots::master
