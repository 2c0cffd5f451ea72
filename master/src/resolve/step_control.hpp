// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"

namespace mebots::master {

/// Determines which errors step control measures, and whether it repeats steps. Has no effect if the description has no
/// `step_control`. Throws InputError if an instance cannot change the length of its step, if no error can be measured,
/// or if an FMU lacks a required rollback. Also throws if a name in the config is neither a bond nor a connected Real
/// input. Must be called after resolve_connections().
void resolve_step_control(ResolvedSystem& system);

}  // namespace mebots::master
