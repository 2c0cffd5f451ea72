// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"
#include "slave/discrete_link.hpp"

#include <cstddef>

namespace mebots::master {

/// Returns a link that copies the connection's value between two members of a group. `from` and `to` are the indices of
/// the members in the group.
DiscreteLink link_of(const ResolvedConnection& connection, std::size_t from, std::size_t to);

}  // namespace mebots::master
