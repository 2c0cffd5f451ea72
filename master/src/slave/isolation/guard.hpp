// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol.hpp"

#include <cstdint>

namespace mebots::master::isolation {

enum class LimitedMemory : std::uint8_t {
  address_space,  ///< limits the growth of the address space from its current size
  data,           ///< limits private writable memory, because wine reserves many addresses that it does not use
};

/// Prepares a host process for an FMU. Limits its memory to `memory_bytes`. If the process crashes, writes the fault to
/// `control`. The process must have only one thread.
void guard(std::uint64_t memory_bytes, LimitedMemory limited, Control& control);

/// Prevents this process from ending, changing or observing processes that are not its children. The process must have
/// only one thread.
void protect_other_processes();

enum class Signals : std::uint8_t {
  to_children,  ///< the kernel restricts signals (see shield_other_processes())
  to_itself,    ///< a seccomp filter permits only signals to the process itself
};

/// Makes the system calls that end, change or observe other processes fail with EPERM. System calls of another
/// architecture than x86-64 end the process, because their numbers have other meanings. Has no effect if the system
/// does not support such filters.
void forbid_harm(Signals signals);

}  // namespace mebots::master::isolation
