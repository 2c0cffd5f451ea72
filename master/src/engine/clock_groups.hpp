// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "message/message_hub.hpp"
#include "model/resolved_system.hpp"
#include "slave/clocked/clock_group.hpp"

#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

namespace mebots::master {

/// Creates the slaves of instances with ticking clocks, and the groups in which these slaves step together.
class ClockGroups {
 public:
  /// All arguments must outlive the slaves. If `*interrupted` becomes true during a call to an isolated instance, the
  /// instance's process is killed. If `interrupted` is null, calls cannot be interrupted.
  ClockGroups(const ResolvedSystem& system, MessageSink& messages, const std::atomic<bool>* interrupted);

  /// Creates the slave of an instance with ticking clocks. Must be called for the instances in the order of the config.
  std::unique_ptr<Slave> make_slave(std::size_t instance);
  /// Connects the members of each group. Must be called once, after the last make_slave().
  void connect();

 private:
  /// The group of an instance, and the index of the instance in this group.
  struct Place {
    std::size_t group = 0;
    std::size_t member = 0;
  };

  const ResolvedSystem& system_;
  MessageSink& messages_;
  const std::atomic<bool>* interrupted_;
  std::vector<Place> places_;  // indexed by instance
  std::vector<std::shared_ptr<ClockGroup>> groups_;
};

}  // namespace mebots::master
