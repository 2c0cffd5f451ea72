// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol.hpp"

#include <cstdint>

namespace mebots::master::isolation {

/// What a host process does before it touches foreign code. It takes no more than `memory_bytes` beyond what it has
/// already, can do nothing to processes that are not its children, and tells `control` of a fault before it dies of it.
/// One thread only.
void guard(std::uint64_t memory_bytes, Control& control);

enum class Signals : std::uint8_t {
  to_children,  ///< the kernel keeps them inside (see landlock.hpp)
  to_itself,    ///< by the arguments of calls: to this very process alone
};

/// Takes from the process the system calls that end, change or watch other processes: each answers EPERM. Calls in
/// another form than x86-64's, which rules by number would not see, end the process. Where the system allows no such
/// filter, nothing changes.
void forbid_harm(Signals signals);

}  // namespace mebots::master::isolation
