// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/time_grid.hpp"
#include "message/message_hub.hpp"
#include "model/resolved_system.hpp"
#include "slave/slave.hpp"

#include "child_process.hpp"
#include "model/value_kind.hpp"
#include "protocol.hpp"

#include <atomic>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace mebots::master::isolation {

/// A slave in a separate process (mebots-fmu-host). Values to set are sent with the next call that needs an answer. A
/// step also requests the outputs that were read after the previous step. A communication step therefore needs only one
/// exchange of messages. After the process has ended or a call has exceeded its deadline, every call throws SlaveError.
class IsolatedSlave : public Slave {
 public:
  /// Number of file descriptors of the master for each instance.
  static constexpr std::size_t kDescriptors = 2;

  /// Starts the process and creates the instance. If `*interrupted` becomes true during a call, the process is killed.
  /// `interrupted` may be null. `instance`, `messages` and `interrupted` must outlive the slave.
  IsolatedSlave(const ResolvedInstance& instance, MessageSink& messages, const std::atomic<bool>* interrupted,
                const TimeGrid& grid = {});
  ~IsolatedSlave() override;
  IsolatedSlave(const IsolatedSlave&) = delete;
  IsolatedSlave& operator=(const IsolatedSlave&) = delete;

  const std::string& name() const override { return name_; }
  const modeldesc::ModelDescription& description() const override { return *instance_->model; }

  void setup_experiment(const Experiment& experiment) override;
  void enter_initialization() override;
  void exit_initialization() override;
  StepResult step(std::int64_t start_ns, std::int64_t duration_ns) override;
  StepResult finish_step(const std::atomic<bool>& cancel) override;
  void terminate() override;
  std::optional<std::string> free_instance() override;

  void get_reals(std::span<const ValueReference> references, std::span<double> values) override;
  void get_integers(std::span<const ValueReference> references, std::span<std::int64_t> values) override;
  void get_booleans(std::span<const ValueReference> references, std::span<std::int64_t> values) override;
  void get_strings(std::span<const ValueReference> references, std::span<std::string> values) override;
  void set_reals(std::span<const ValueReference> references, std::span<const double> values) override;
  void set_integers(std::span<const ValueReference> references, std::span<const std::int64_t> values) override;
  void set_booleans(std::span<const ValueReference> references, std::span<const std::int64_t> values) override;
  void set_strings(std::span<const ValueReference> references, std::span<const std::string> values) override;
  void get_binaries(std::span<const ValueReference> references, std::span<std::string> values) override;
  void set_binaries(std::span<const ValueReference> references, std::span<const std::string> values) override;

  std::uint32_t output_derivative_order() const override { return output_derivative_order_; }
  bool takes_input_derivatives() const override { return takes_input_derivatives_; }
  std::vector<std::string> notices() const override { return notices_; }
  void get_output_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                              std::span<double> values) override;
  void set_input_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                             std::span<const double> values) override;

  std::unique_ptr<SlaveState> save_state() override;
  void restore_state(const SlaveState& state) override;
  std::vector<std::byte> serialize(const SlaveState& state) override;
  std::unique_ptr<SlaveState> deserialize(std::span<const std::byte> bytes) override;

 protected:
  bool provides_directional_derivatives() const { return provides_directional_derivatives_; }
  /// Sets the simulated time for messages about this instance.
  void set_time_ns(std::int64_t time_ns) { time_ns_ = time_ns; }
  /// Appends a call without an answer to the next batch.
  template <typename... Arguments>
  void defer(Call call, const Arguments&... arguments) {
    forget_reads();
    put(call);
    (commands_.put(arguments), ...);
    ++pending_;
  }
  /// Sends a call and waits for its answer. `take` reads the answer.
  template <typename... Arguments>
  void exchange(Call call, const std::function<void(SharedReader&)>& take, const Arguments&... arguments) {
    forget_reads();
    put(call);
    (commands_.put(arguments), ...);
    hand_over(1, [&](SharedReader& answers) {
      check(answers);
      take(answers);
    });
  }

 private:
  friend class IsolatedState;

  /// A request of outputs, and its answer of the last step.
  struct Read {
    Call call = Call::none;
    std::vector<ValueReference> references;
    std::vector<std::int32_t> orders;  // for derivatives only
    bool used = false;                 // true if the values were read since the last step
    bool fresh = false;                // true if no call since the step has made the answer invalid
    std::exception_ptr failure;
    std::vector<double> reals;
    std::vector<std::int64_t> integers;  // also Booleans
    std::vector<std::string> strings;
  };

  void open(const TimeGrid& grid);
  std::vector<std::string> host_arguments() const;
  const char* call_name() const;
  std::uint64_t memory_bytes() const;
  void put(Call call) { commands_.put(call); }
  void put_references(Call call, std::span<const ValueReference> references);
  void put_texts(Call call, std::span<const ValueReference> references, std::span<const std::string> values);
  /// Sends all written calls and waits for their answers. Checks all answers except the last `open_answers`, which
  /// `take` must read. Ends the process if an answer is invalid.
  void hand_over(std::size_t open_answers = 0, const std::function<void(SharedReader&)>& take = {});
  void wait(std::size_t calls);
  SharedReader answers();
  void check(SharedReader& answers);
  void take_messages();
  std::optional<std::string> report_end();
  std::optional<std::string> failure_of_close();
  [[noreturn]] void lost(ErrorCode code, const std::string& how);
  ProcessEnd end_in_sandbox(ProcessEnd end) const;
  std::string fault_text(const ProcessEnd& seen) const;
  Read& read(Call call, std::span<const ValueReference> references, std::span<const std::int32_t> orders = {});
  void put_read(Call call, std::span<const ValueReference> references, std::span<const std::int32_t> orders);
  void take(Read& read, SharedReader& answers);
  void take_reads(SharedReader& answers);
  StepResult hand_over_step();
  void take_binaries(Read& read, SharedReader& answers);
  void forget_reads();
  void free_state(std::uint64_t id) noexcept;

  const ResolvedInstance* instance_;
  std::string name_;
  MessageSink* messages_;
  const std::atomic<bool>* interrupted_;
  SharedBuffer control_buffer_;
  SharedBuffer command_buffer_;
  SharedBuffer answer_buffer_;
  SharedBuffer log_buffer_;
  Control* control_;
  SharedWriter commands_;
  std::size_t pending_ = 0;    // number of calls that are written but not sent
  std::uint32_t batches_ = 0;  // number of answered batches
  std::unique_ptr<ChildProcess> process_;
  const std::atomic<bool>* cancel_ = nullptr;  // true cancels the pending step
  std::string lost_;                           // reason why the process ended; empty while it is running
  bool freed_ = false;

  // Capabilities of the FMU, which the host process reports after it has loaded the library.
  std::uint32_t output_derivative_order_ = 0;
  bool takes_input_derivatives_ = false;
  bool provides_directional_derivatives_ = false;
  std::vector<std::string> notices_;

  std::int64_t time_ns_ = 0;
  std::int64_t step_end_ns_ = 0;
  std::vector<Read> reads_;  // requests since the last step
  std::vector<OsmpTriple> triples_;
  // The bytes of each OSMP binary in `triples_`. There are two buffers for each, so that bytes stay valid during the
  // next step.
  std::vector<std::array<std::vector<std::uint8_t>, 2>> binaries_;
  std::size_t turn_ = 0;
  std::uint64_t states_ = 0;  // number of saved and deserialized states
};

}  // namespace mebots::master::isolation
