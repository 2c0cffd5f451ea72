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

/// Creates those slaves of a resolved system that have ticking clocks, and the groups in which they step.
class ClockGroups {
 public:
  /// All arguments must outlive the slaves. If `*interrupted` becomes true while a call to an isolated instance does
  /// not return, its process is ended. If `interrupted` is null, calls cannot be interrupted.
  ClockGroups(const ResolvedSystem& system, MessageSink& messages, const std::atomic<bool>* interrupted);

  /// Instantiates an instance whose clocks tick. Must be called in the order of the config.
  std::unique_ptr<Slave> make_slave(std::size_t instance);
  /// Connects the members of each group. Must be called after the last make_slave().
  void connect();

 private:
  /// The group of an instance, and its index in the group.
  struct Place {
    std::size_t group = 0;
    std::size_t member = 0;
  };

  const ResolvedSystem& system_;
  MessageSink& messages_;
  const std::atomic<bool>* interrupted_;
  std::vector<Place> places_;  // by instance
  std::vector<std::shared_ptr<ClockGroup>> groups_;
};

}  // namespace mebots::master
