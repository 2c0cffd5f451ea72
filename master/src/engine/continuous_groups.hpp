// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "message/message_hub.hpp"
#include "model/resolved_system.hpp"
#include "slave/continuous/continuous_group.hpp"
#include "slave/slave_options.hpp"

#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

namespace mebots::master {

/// Creates the slaves of model exchange instances, and the groups that integrate these slaves together.
class ContinuousGroups {
 public:
  /// All arguments must outlive the slaves.
  ContinuousGroups(const ResolvedSystem& system, MessageSink& messages, const SlaveOptions& options);

  /// Creates the slave of a model exchange instance. Must be called for the instances in the order of the config.
  std::unique_ptr<Slave> make_slave(std::size_t instance);
  /// Connects the members of each group. Must be called after the last make_slave().
  void connect();

 private:
  /// The continuous system of an instance, and the index of the instance in this system.
  struct Place {
    std::size_t system = 0;
    std::size_t member = 0;
  };

  void connect(const ResolvedConnection& connection);
  bool is_wire(const ResolvedConnection& connection) const;

  const ResolvedSystem& system_;
  MessageSink& messages_;
  const std::atomic<bool>* interrupted_;
  std::vector<Place> places_;  // indexed by instance
  std::vector<std::shared_ptr<ContinuousGroup>> groups_;
  std::vector<std::vector<Wire>> wires_;          // indexed by system
  std::vector<std::vector<DiscreteLink>> links_;  // indexed by system
};

}  // namespace mebots::master
