// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"
#include "slave/clocked/clock_network.hpp"

#include <cstddef>
#include <functional>
#include <vector>

namespace mebots::master {

struct ClockLinks {
  std::vector<ClockLink> clocks;
  std::vector<ClockedLink> values;
};

/// Returns the connections between clocks and between clocked variables. `member_of` must return the index of an
/// instance in its group.
ClockLinks clock_links(const std::vector<ResolvedConnection>& connections,
                       const std::function<std::size_t(std::size_t instance)>& member_of);

}  // namespace mebots::master
