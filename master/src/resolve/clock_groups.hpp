// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/fmu_kind.hpp"
#include "model/resolved_system.hpp"

namespace mebots::master {

/// True if the master handles the clocks of an instance. This requires FMI 3.0, an event mode, and a Clock as input or
/// output.
bool has_ticking_clocks(const modeldesc::ModelDescription& model, FmuKind kind);

/// True for a connection of clocks or clocked variables. Such a connection transfers values only while clocks of both
/// ends tick.
bool is_carried_by_ticks(const ResolvedConnection& connection);

/// Moves connections of clocks and clocked variables from the system to its clock groups and continuous systems. Throws
/// InputError if the members of a group cannot step together.
void resolve_clock_groups(ResolvedSystem& system);

}  // namespace mebots::master
