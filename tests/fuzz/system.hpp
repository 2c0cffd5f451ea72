// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/system_description.hpp"

#include "require.hpp"

#include <cmath>

namespace mebots::fuzz {

/// Checks the properties of a system on which the callers of its readers (configs, SSPs) rely.
inline void require_sound(const master::SystemDescription& system) {
  require(system.step.numerator > 0, "the step is above 0");
  const auto grid = system.grid();
  require(system.stop_time_ns > system.start_time_ns && grid.is_point(system.stop_time_ns),
          "the end is a communication point");
  const auto last = grid.point_at(system.stop_time_ns);
  require(!system.instances.empty(), "there are instances");
  for (const auto& instance : system.instances) {
    require(instance.steps > 0, "an instance's step is a multiple");
    require(last % instance.steps == 0, "the end is a communication point of every instance");
  }
  for (const auto& connection : system.connections) {
    require(system.find_instance(connection.from.instance) != nullptr, "a connection begins at an instance");
    require(system.find_instance(connection.to.instance) != nullptr, "a connection ends at an instance");
    require(std::isfinite(connection.factor) && std::isfinite(connection.offset), "a connection's numbers are finite");
  }
}

}  // namespace mebots::fuzz
