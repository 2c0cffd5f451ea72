// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol.hpp"

#include <cstdint>

namespace mebots::master::isolation {

enum class LimitedMemory : std::uint8_t {
  address_space,  ///< limits the address space, in addition to its current size
  data,           ///< limits private writable memory, because wine reserves far more addresses than it uses
};

/// Prepares a host process for foreign code. Limits its memory to `memory_bytes`. If a fault ends the process, first
/// writes the fault to `control`. The process must have only one thread.
void guard(std::uint64_t memory_bytes, LimitedMemory limited, Control& control);

/// Prevents this process from ending, changing or watching processes that are not its children. The process must have
/// only one thread.
void protect_other_processes();

enum class Signals : std::uint8_t {
  to_children,  ///< the kernel limits signals (see shield_other_processes())
  to_itself,    ///< a filter of arguments permits only signals to the process itself
};

/// Forbids the system calls that end, change or watch other processes: each of them fails with EPERM. System calls of
/// another architecture than x86-64 end the process, because their numbers have another meaning. If the system permits
/// no such filter, has no effect.
void forbid_harm(Signals signals);

}  // namespace mebots::master::isolation
