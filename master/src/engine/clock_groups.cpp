// SPDX-License-Identifier: Apache-2.0
#include "engine/clock_groups.hpp"

#include "engine/clock_links.hpp"
#include "slave/clocked/clocked_slave.hpp"
#include "slave/fmi/make_slave.hpp"
#include "slave/isolation/isolated_interfaces.hpp"

#include <utility>

namespace mebots::master {
namespace {

/// Adds a slave to a group and wraps the slave for this group. `slave` and `instance` must be the same object.
std::unique_ptr<Slave> in_group(std::unique_ptr<Slave> slave, EventInstance& instance,
                                const std::shared_ptr<ClockGroup>& group) {
  auto holding = std::make_unique<HoldingSlave>(std::move(slave));
  const auto member = group->add(*holding, instance);
  return std::make_unique<ClockedSlave>(std::move(holding), member, group);
}

}  // namespace

ClockGroups::ClockGroups(const ResolvedSystem& system, MessageSink& messages, const std::atomic<bool>* interrupted)
    : system_(system), messages_(messages), interrupted_(interrupted), places_(system.instances.size()) {
  for (std::size_t g = 0; g < system.clock_groups.size(); ++g) {
    const auto& members = system.clock_groups[g].members;
    for (std::size_t m = 0; m < members.size(); ++m) places_[members[m]] = {g, m};
    groups_.push_back(std::make_shared<ClockGroup>(system.description->grid(), messages));
  }
}

std::unique_ptr<Slave> ClockGroups::make_slave(std::size_t instance) {
  const auto& resolved = system_.instances[instance];
  const auto& group = groups_[places_[instance].group];
  if (resolved.isolation.alone()) {
    auto isolated =
        std::make_unique<isolation::IsolatedEventSlave>(resolved, messages_, interrupted_, system_.description->grid());
    auto& remote = *isolated;
    return in_group(std::move(isolated), remote, group);
  }
  auto [slave, events] = make_event_slave_here({.name = resolved.description->name,
                                                .fmu = resolved.fmu,
                                                .structural = resolved.structural,
                                                .log_categories = resolved.log_categories,
                                                .grid = system_.description->grid()},
                                               messages_);
  return in_group(std::move(slave), *events, group);
}

void ClockGroups::connect() {
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    auto [clocks, values] = clock_links(system_.clock_groups[g].connections,
                                        [this](std::size_t instance) { return places_[instance].member; });
    groups_[g]->connect(std::move(clocks), std::move(values));
  }
}

}  // namespace mebots::master
