// SPDX-License-Identifier: Apache-2.0
#include "slave_factory.hpp"

#include "mebots/master/fmu_slave.hpp"

#include "timed_slave.hpp"

namespace mebots::master {

std::vector<std::unique_ptr<Slave>> make_slaves(const ResolvedSystem& system, MessageSink& messages,
                                                const SlaveOptions& options) {
  if (options.statistics != nullptr) options.statistics->instances.resize(system.instances.size());
  std::vector<std::unique_ptr<Slave>> slaves;
  for (std::size_t i = 0; i < system.instances.size(); ++i) {
    const auto& instance = system.instances[i];
    const auto& name = instance.description->name;
    std::unique_ptr<Slave> slave = std::make_unique<FmuSlave>(name, instance.fmu, instance.log_categories, messages);
    if (options.statistics != nullptr) {
      auto& statistics = options.statistics->instances[i];
      statistics.name = name;
      slave = std::make_unique<TimedSlave>(std::move(slave), statistics);
    }
    slaves.push_back(std::move(slave));
  }
  return slaves;
}

}  // namespace mebots::master
