// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "soc/soc.hpp"

#include <optional>

namespace mebots::soc::tool {

/// Prints what a run did: instructions, cycles, time, energy by component, speed of the host, tohost.
void print_report(const Soc& soc, double host_s, std::optional<std::uint32_t> tohost);

}  // namespace mebots::soc::tool
