// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/system_description.hpp"

#include "require.hpp"

#include <cmath>

namespace mebots::fuzz {

/// What everybody behind the readers of configs and SSPs counts on.
inline void require_sound(const master::SystemDescription& system) {
  require(system.step_ns > 0, "the step is above 0");
  const auto length_ns = system.stop_time_ns - system.start_time_ns;
  require(length_ns > 0 && length_ns % system.step_ns == 0, "the end is a communication point");
  require(!system.instances.empty(), "there are instances");
  for (const auto& instance : system.instances) {
    require(instance.step_ns > 0 && instance.step_ns % system.step_ns == 0, "an instance's step is a multiple");
    require(length_ns % instance.step_ns == 0, "the end is a communication point of every instance");
  }
  for (const auto& connection : system.connections) {
    require(system.find_instance(connection.from.instance) != nullptr, "a connection begins at an instance");
    require(system.find_instance(connection.to.instance) != nullptr, "a connection ends at an instance");
    require(std::isfinite(connection.factor) && std::isfinite(connection.offset), "a connection's numbers are finite");
  }
}

}  // namespace mebots::fuzz
