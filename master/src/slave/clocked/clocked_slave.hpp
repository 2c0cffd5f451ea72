// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slave/forwarding_slave.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace mebots::master {

class ClockGroup;

/// A slave for a co-simulation instance with clocks. Its step advances all instances of its group.
class ClockedSlave final : public ForwardingSlave {
 public:
  /// `inner` must have been added to `group` with the index `member`.
  ClockedSlave(std::unique_ptr<Slave> inner, std::size_t member, std::shared_ptr<ClockGroup> group);

  void setup_experiment(const Experiment& experiment) override;
  void exit_initialization() override;
  StepResult step(std::int64_t start_ns, std::int64_t duration_ns) override;
  std::optional<double> next_event_s() const override;
  std::uint32_t output_derivative_order() const override { return 0; }

  std::unique_ptr<SlaveState> save_state() override;
  void restore_state(const SlaveState& state) override;
  std::vector<std::byte> serialize(const SlaveState& state) override;
  std::unique_ptr<SlaveState> deserialize(std::span<const std::byte> bytes) override;

 private:
  std::shared_ptr<ClockGroup> group_;
  std::size_t member_;
};

}  // namespace mebots::master
