// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/fmu_kind.hpp"
#include "model/resolved_system.hpp"

namespace mebots::master {

/// True if the master handles the clocks of such an instance: co-simulation with an event mode and an input or output
/// of type Clock.
bool has_ticking_clocks(const modeldesc::ModelDescription& model, FmuKind kind);

/// Moves connections between clocked variables from the system to its clock groups. Throws InputError if members cannot
/// step together.
void resolve_clock_groups(ResolvedSystem& system);

}  // namespace mebots::master
