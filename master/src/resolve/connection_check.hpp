// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"

#include <atomic>

namespace mebots::master {

/// Looks up both ends of every connection of `system.description`, checks that they fit, and fills
/// `system.connections`, in the order of the instances that they go to. Throws InputError, and InterruptedError.
void resolve_connections(ResolvedSystem& system, const std::atomic<bool>& interrupted);

}  // namespace mebots::master
