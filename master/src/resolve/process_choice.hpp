// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace mebots::master {

struct ResolvedSystem;

/// Loads the FMUs that share this process. An instance whose FMU cannot share it gets its own process, and
/// `system.notices` says why. Throws InputError if the config demands `"process": "shared"` of such an instance or if a
/// library cannot be loaded, and InterruptedError between two FMUs.
void choose_processes(ResolvedSystem& system, const std::atomic<bool>& interrupted);

}  // namespace mebots::master
