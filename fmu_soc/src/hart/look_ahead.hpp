// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "memory/memory.hpp"

#include <array>
#include <cstdint>
#include <optional>

namespace mebots::soc {

/// The value that a core is about to store at `address`. Follows the next few instructions from `pc` with the registers
/// `x` on, without any effect. Nothing if another store to the same eight bytes comes first, or if the instructions do
/// what cannot be foreseen: an access to a device, a CSR, a trap.
std::optional<std::uint32_t> upcoming_store(const Memory& memory, std::uint32_t pc, std::array<std::uint32_t, 32> x,
                                            std::uint32_t address);

}  // namespace mebots::soc
