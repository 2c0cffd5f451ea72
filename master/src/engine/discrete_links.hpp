// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"
#include "slave/discrete_link.hpp"

#include <cstddef>

namespace mebots::master {

/// Returns a link that copies a connection's value from one member of a group to another. `from` and `to` are indices
/// of members.
DiscreteLink link_of(const ResolvedConnection& connection, std::size_t from, std::size_t to);

}  // namespace mebots::master
