// SPDX-License-Identifier: Apache-2.0
#include "engine/clock_groups.hpp"
#include "engine/continuous_groups.hpp"
#include "engine/ensemble.hpp"

#include "slave/fmi/make_slave.hpp"

#include "slave/isolation/isolated_slave.hpp"
#include "slave/overridden_slave.hpp"
#include "slave/timed_slave.hpp"
#include "slave/tolerant_slave.hpp"

#include <algorithm>

namespace mebots::master {
namespace {

bool overrides_any_of(const OverrideSchedule& schedule, std::size_t instance) {
  return std::any_of(schedule.overrides().begin(), schedule.overrides().end(),
                     [&](const Override& override) { return override.variable.instance == instance; });
}

}  // namespace

std::vector<std::unique_ptr<Slave>> make_slaves(const ResolvedSystem& system, MessageSink& messages,
                                                const SlaveOptions& options) {
  if (options.statistics != nullptr) options.statistics->instances.resize(system.instances.size());
  if (options.losses != nullptr) options.losses->resize(system.instances.size());
  const auto grid = system.description->grid();
  ContinuousGroups continuous(system, messages, options);
  ClockGroups clocks(system, messages, options.interrupted);
  std::vector<std::unique_ptr<Slave>> slaves;
  for (std::size_t i = 0; i < system.instances.size(); ++i) {
    const auto& instance = system.instances[i];
    const auto& name = instance.description->name;
    const auto& wish = instance.isolation;
    std::unique_ptr<Slave> slave;
    if (instance.kind == FmuKind::model_exchange) {
      slave = continuous.make_slave(i);
    } else if (instance.clocks_tick) {
      slave = clocks.make_slave(i);
    } else if (wish.alone()) {
      slave = std::make_unique<isolation::IsolatedSlave>(instance, messages, options.interrupted, grid);
    } else {
      slave = make_slave_here({.name = name,
                               .fmu = instance.fmu,
                               .structural = instance.structural,
                               .log_categories = instance.log_categories,
                               .grid = grid},
                              messages);
    }
    if (wish.continue_without && options.losses != nullptr) {
      auto& loss = (*options.losses)[i];
      loss.name = name;
      slave = std::make_unique<TolerantSlave>(std::move(slave), messages, loss);
    }
    if (options.overrides != nullptr && overrides_any_of(*options.overrides, i)) {
      slave = std::make_unique<OverriddenSlave>(std::move(slave), *options.overrides, i,
                                                to_nanoseconds(system.description->step_of(*instance.description)));
    }
    if (options.statistics != nullptr) {
      auto& statistics = options.statistics->instances[i];
      statistics.name = name;
      slave = std::make_unique<TimedSlave>(std::move(slave), statistics);
    }
    slaves.push_back(std::move(slave));
  }
  continuous.connect();
  clocks.connect();
  return slaves;
}

}  // namespace mebots::master
