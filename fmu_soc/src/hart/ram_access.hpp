// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/execution.hpp"
#include "mebots/assert.hpp"

namespace mebots::soc {

/// Pointers to the bytes of a load or store in fast RAM. If both are null, the address is not in fast RAM, and the
/// hart's slow path must perform the access.
struct RamAccess {
  std::uint8_t* data = nullptr;
  std::uint8_t* marks = nullptr;  // marks of the first word that the access touches
};

/// The fast region that contains an access, and the offset of the access in this region. `region` is null if no fast
/// region contains the access.
struct RamPlace {
  const FastRegion* region = nullptr;
  std::uint32_t offset = 0;
};

[[gnu::always_inline]] inline RamPlace find_ram(const Execution& e, std::uint32_t address) {
  for (const auto& ram : e.ram) {
    const auto offset = address - ram.base;
    if (offset < ram.span) [[likely]]
      return {&ram, offset};
  }
  return {};
}

/// Counts an access as if it lay within one word. Does not claim the bank of the word.
[[gnu::always_inline]] inline RamAccess count_access(Execution& e, const RamPlace& place) {
  MEBOTS_ASSERT(place.region != nullptr && place.offset < place.region->span);
  const auto& ram = *place.region;
  if (&ram != &e.ram[0]) ++e.counters.far_accesses;
  if (ram.wait_cycles != 0) e.extra_cycles += ram.wait_cycles;
  return {ram.data + place.offset, ram.marks + place.offset / 4};
}

/// Performs an access if it is in fast RAM, within one word, and without shared banks. Otherwise has no effect. Makes
/// no calls, so that a handler need not save registers.
template <unsigned Size>
[[gnu::always_inline]] inline RamAccess quick_access(Execution& e, std::uint32_t address) {
  const auto place = find_ram(e, address);
  if (place.region == nullptr || place.region->banks != nullptr) return {};
  if (Size > 1 && crosses_word(address, Size)) return {};
  return count_access(e, place);
}

/// Finds the bytes of an access in fast RAM. Adds its wait cycles: the latency and, if banks are shared, the waits for
/// the bank. An access across a word boundary is two bus accesses, which both wait. The caller adds the cycle of the
/// second bus access (kMisalignedExtra).
template <unsigned Size>
[[gnu::always_inline]] inline RamAccess ram_access(Execution& e, const Instruction* at, std::uint32_t address) {
  const auto place = find_ram(e, address);
  if (place.region == nullptr) return {};
  const auto access = count_access(e, place);
  const auto& ram = *place.region;
  if (ram.banks != nullptr) e.extra_cycles += ram.banks->claim(e.cycle_of(at), address);
  if constexpr (Size > 1) {
    if (crosses_word(address, Size)) {
      e.extra_cycles += ram.wait_cycles;
      if (ram.banks != nullptr) e.extra_cycles += ram.banks->claim(e.cycle_of(at) + 1, address + 4);
    }
  }
  return access;
}

}  // namespace mebots::soc
