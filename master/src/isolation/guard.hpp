// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol.hpp"

#include <sys/types.h>
#include <cstdint>

namespace mebots::master::isolation {

/// From now on this process ends when `parent` does, and dumps no core.
void end_with(pid_t parent);

/// What a host process does before it touches foreign code: takes no more than `memory_bytes` beyond what it has
/// already, can do nothing to the master, its group or other processes, and tells `control` of a fault before it dies
/// of it.
void guard(pid_t master, std::uint64_t memory_bytes, Control& control);

}  // namespace mebots::master::isolation
