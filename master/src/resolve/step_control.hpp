// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"

namespace mebots::master {

/// Determines which errors step control measures, and whether it repeats steps. Has no effect if the description has no
/// `step_control`. Throws InputError for instances that cannot change their step, for a name that is neither a bond nor
/// a connected Real input, if nothing is left to measure, and for a rollback that an FMU does not support. Must be
/// called after resolve_connections().
void resolve_step_control(ResolvedSystem& system);

}  // namespace mebots::master
