// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/master/forwarding_slave.hpp"
#include "mebots/master/message.hpp"
#include "mebots/master/slave_options.hpp"
#include "mebots/state/bytes.hpp"

namespace mebots::master {

/// Lets the others go on when the slave behind it fails in or after its first step: from then on its outputs stand
/// still at what was read last, and what it is given is dropped.
class TolerantSlave final : public ForwardingSlave {
 public:
  /// `messages` hears of the loss, and `loss` says of it; both must outlive the slave.
  TolerantSlave(std::unique_ptr<Slave> inner, MessageSink& messages, InstanceLoss& loss)
      : ForwardingSlave(std::move(inner)), messages_(&messages), loss_(&loss) {}

  StepResult step(std::int64_t start_ns, std::int64_t duration_ns) override;
  void terminate() override;

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
  /// Values as they were read last, by the references they were asked for by.
  template <typename T>
  struct Kept {
    std::vector<ValueReference> references;
    std::vector<T> values;
  };

  bool lost() const { return loss_->at_ns >= 0; }
  template <typename Work>
  void attempt(Work work);
  template <typename T, typename Get>
  void get(std::vector<Kept<T>>& all, std::span<const ValueReference> references, std::span<T> values, Get get);
  void save_kept(state::Writer& writer) const;
  void restore_kept(state::Reader& reader);

  MessageSink* messages_;
  InstanceLoss* loss_;
  bool running_ = false;
  std::int64_t time_ns_ = 0;
  std::vector<Kept<double>> reals_;
  std::vector<Kept<std::int32_t>> integers_;
  std::vector<Kept<std::int32_t>> booleans_;
  std::vector<Kept<std::string>> strings_;
};

}  // namespace mebots::master
