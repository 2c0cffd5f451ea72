// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/fmu_kind.hpp"
#include "model/resolved_system.hpp"

namespace mebots::master {

/// True if the master lets the clocks of such an instance tick: it is of co-simulation with an event mode, and has an
/// input or output of type Clock.
bool has_ticking_clocks(const modeldesc::ModelDescription& model, FmuKind kind);

/// Moves connections between variables that belong to clocks from the system to its clock groups. Throws InputError for
/// members that cannot step together.
void resolve_clock_groups(ResolvedSystem& system);

}  // namespace mebots::master
