// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"

namespace mebots::master {

/// Selects the coupling errors that step control measures, and decides whether it repeats steps. Has no effect if the
/// description contains no `step_control`. Throws InputError if an instance cannot change the length of its step, if no
/// error can be measured, or if rollback is required and an FMU does not support it. Also throws if a name in the
/// config is neither a bond nor a connected Real input. Must be called after resolve_connections().
void resolve_step_control(ResolvedSystem& system);

}  // namespace mebots::master
