// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol.hpp"

#include <sys/types.h>
#include <cstdint>

namespace mebots::master::isolation {

/// What a host process does before it touches foreign code: takes no more than `memory_bytes` beyond what it has
/// already, can do nothing to the master, its keeper, their groups or other processes, and tells `control` of a fault
/// before it dies of it.
void guard(pid_t master, std::uint64_t memory_bytes, Control& control);

}  // namespace mebots::master::isolation
