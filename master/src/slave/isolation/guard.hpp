// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol.hpp"

#include <cstdint>

namespace mebots::master::isolation {

/// Prepares a host process for foreign code: limits its memory to `memory_bytes` beyond what it has already, and lets
/// it write a fault to `control` before the fault ends it. One thread only.
void guard(std::uint64_t memory_bytes, Control& control);

/// Takes from this process the means to end, change or watch processes that are not its children. One thread only.
void protect_other_processes();

enum class Signals : std::uint8_t {
  to_children,  ///< the kernel limits them, see shield_other_processes()
  to_itself,    ///< by the arguments of calls: to this very process alone
};

/// Takes from the process the system calls that end, change or watch other processes: each answers EPERM. Calls in
/// another form than x86-64's, which rules by number would not see, end the process. Where the system allows no such
/// filter, nothing changes.
void forbid_harm(Signals signals);

}  // namespace mebots::master::isolation
