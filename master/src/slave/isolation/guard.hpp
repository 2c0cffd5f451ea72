// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol.hpp"

#include <cstdint>

namespace mebots::master::isolation {

enum class LimitedMemory : std::uint8_t {
  address_space,  ///< above the present use
  data,           ///< private memory that the process may write: wine reserves far more addresses than it uses
};

/// Prepares a host process for foreign code: limits its memory to `memory_bytes`, and writes a fault to `control`
/// before the fault ends the process. One thread only.
void guard(std::uint64_t memory_bytes, LimitedMemory limited, Control& control);

/// Prevents this process from ending, changing or watching processes that are not its children. One thread only.
void protect_other_processes();

enum class Signals : std::uint8_t {
  to_children,  ///< the kernel limits signals, see shield_other_processes()
  to_itself,    ///< a filter of arguments limits signals to this very process
};

/// Forbids the system calls that end, change or watch other processes: each fails with EPERM. Calls of another
/// architecture than x86-64 end the process, because their numbers have another meaning. If the system allows no such
/// filter, changes nothing.
void forbid_harm(Signals signals);

}  // namespace mebots::master::isolation
