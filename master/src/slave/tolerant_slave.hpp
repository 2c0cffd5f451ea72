// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "message/message_hub.hpp"
#include "slave/access_slave.hpp"
#include "slave/slave_options.hpp"

namespace mebots::master {

/// Lets the run continue if the wrapped slave fails during or after its first step. After the failure, outputs keep
/// their last values, and inputs are ignored.
class TolerantSlave final : public AccessSlave {
 public:
  /// Reports a failure to `messages` and stores it in `loss`. Both must outlive the slave.
  TolerantSlave(std::unique_ptr<Slave> inner, MessageSink& messages, InstanceLoss& loss)
      : AccessSlave(std::move(inner)), messages_(&messages), loss_(&loss) {}

  StepResult step(std::int64_t start_ns, std::int64_t duration_ns) override;
  StepResult finish_step(const std::atomic<bool>& cancel) override;
  void terminate() override;
  /// Frees the slave. Logs errors and always returns nullopt, because they do not affect the run.
  std::optional<std::string> free_instance() override;
  /// Gets derivatives of outputs. After a failure, they are 0.
  void get_output_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                              std::span<double> values) override;
  void set_input_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                             std::span<const double> values) override;

  std::unique_ptr<SlaveState> save_state() override;
  void restore_state(const SlaveState& state) override;
  std::vector<std::byte> serialize(const SlaveState& state) override;
  std::unique_ptr<SlaveState> deserialize(std::span<const std::byte> bytes) override;

  /// Visits the time and reason of a failure, and the last values of the outputs.
  void visit(state::Visitor& v);

 private:
  void get(ValueKind kind, std::span<const ValueReference> references, Destination values) override;
  void set(ValueKind kind, std::span<const ValueReference> references, Source values) override;

  /// The last values of a list of outputs.
  template <typename T>
  struct Kept {
    std::vector<ValueReference> references;
    std::vector<T> values;

    void visit(state::Visitor& v) {
      v("references", references);
      v("values", values);
    }
  };

  bool lost() const { return loss_->at_ns.has_value(); }
  template <typename Work>
  void attempt(Work work);
  template <typename T>
  std::vector<Kept<T>>& kept_of(ValueKind kind);

  MessageSink* messages_;
  InstanceLoss* loss_;
  bool running_ = false;
  std::int64_t time_ns_ = 0;
  std::vector<Kept<double>> reals_;
  std::vector<Kept<std::int64_t>> integers_;
  std::vector<Kept<std::int64_t>> booleans_;
  std::vector<Kept<std::string>> strings_;
  std::vector<Kept<std::string>> binaries_;
};

}  // namespace mebots::master
