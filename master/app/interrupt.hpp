// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace mebots::app {

/// Makes Ctrl-C and a polite kill (SIGINT, SIGTERM, SIGHUP) set a flag that the run looks at between two
/// steps. A second signal ends the process at once.
const std::atomic<bool>& catch_interrupts();

}  // namespace mebots::app
