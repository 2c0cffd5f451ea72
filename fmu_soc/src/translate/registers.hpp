// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "translate/region.hpp"

#include <array>
#include <cstdint>

namespace mebots::soc::translate {

/// Number of host registers that hold guest registers.
inline constexpr unsigned kHostRegisters = 9;
/// Number of vector registers that do: what dot products work on.
inline constexpr unsigned kVectorRegisters = 12;

/// Which guest registers live in host registers all through a region; the others stay in memory.
struct Registers {
  static constexpr std::int8_t kInMemory = -1;

  std::array<std::int8_t, 33> host;  // number of the host register, or kInMemory
  std::array<std::uint8_t, kHostRegisters> guest{};
  unsigned count = 0;                  // of host registers in use
  std::array<std::int8_t, 33> vector;  // number of the vector register whose low word it is, or kInMemory
  std::array<std::uint8_t, kVectorRegisters> vector_guest{};
  unsigned vector_count = 0;
  std::array<bool, 33> written{};  // somewhere in the region
};

/// Gives the vector registers to those that dot products use most and that are used by little else, and the host
/// registers to those of the others that are used most.
Registers allocate(const Region& region);

}  // namespace mebots::soc::translate
