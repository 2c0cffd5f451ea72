// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"
#include "slave/discrete_link.hpp"

#include <cstddef>

namespace mebots::master {

/// Returns a link between two members of a group; `from` and `to` are the members' indices in the group.
DiscreteLink link_of(const ResolvedConnection& connection, std::size_t from, std::size_t to);

}  // namespace mebots::master
