// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/fmu_kind.hpp"
#include "model/resolved_system.hpp"

namespace mebots::master {

/// True if the master handles the clocks of an instance. This requires FMI 3.0, the support of event mode, and an input
/// or output of type Clock.
bool has_ticking_clocks(const modeldesc::ModelDescription& model, FmuKind kind);

/// True if the connection connects clocks or clocked variables. Such a connection transfers values at instants at which
/// the clocks of both ends tick.
bool is_carried_by_ticks(const ResolvedConnection& connection);

/// Moves connections between clocked variables from the system to its clock groups and continuous systems. Throws
/// InputError if the members of a group cannot step together.
void resolve_clock_groups(ResolvedSystem& system);

}  // namespace mebots::master
