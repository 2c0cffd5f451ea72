// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol.hpp"

#include <sys/types.h>
#include <cstdint>

namespace mebots::master::isolation {

/// What a host process does before it touches foreign code: ends with its master, dumps no core, takes no more than
/// `memory_bytes` beyond what it has already, cannot send signals to the master, its
/// group or everybody, and tells `control` of a fault before it dies of it.
void guard(pid_t master, std::uint64_t memory_bytes, Control& control);

}  // namespace mebots::master::isolation
