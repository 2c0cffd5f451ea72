// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/execution.hpp"
#include "mebots/assert.hpp"

namespace mebots::soc {

/// The target of a load or store in fast RAM. If both pointers are null, the address is not in fast RAM, and the hart's
/// slow path must make the access.
struct RamAccess {
  std::uint8_t* data = nullptr;
  std::uint8_t* marks = nullptr;  // of the first word that the bytes touch
};

/// The fast region that contains an access, and the offset in this region. If there is no such region, `region` is
/// null.
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

/// Counts an access that lies within one word. Does not claim the bank of that word.
[[gnu::always_inline]] inline RamAccess count_access(Execution& e, const RamPlace& place) {
  MEBOTS_ASSERT(place.region != nullptr && place.offset < place.region->span);
  const auto& ram = *place.region;
  if (&ram != &e.ram[0]) ++e.counters.far_accesses;
  if (ram.wait_cycles != 0) e.extra_cycles += ram.wait_cycles;
  return {ram.data + place.offset, ram.marks + place.offset / 4};
}

/// Performs an access for which one check is sufficient: in fast RAM, within a word, without shared banks. For other
/// accesses, the function has no effect. Calls no function, so that a handler saves no registers.
template <unsigned Size>
[[gnu::always_inline]] inline RamAccess quick_access(Execution& e, std::uint32_t address) {
  const auto place = find_ram(e, address);
  if (place.region == nullptr || place.region->banks != nullptr) return {};
  if (Size > 1 && crosses_word(address, Size)) return {};
  return count_access(e, place);
}

/// Finds the bytes of an access in the two fast regions and adds the wait cycles of the access: latency, and waits for
/// the bank if banks are shared. An access across two words consists of two bus accesses, and each of them waits. The
/// caller adds the extra cycle of the second bus access (kMisalignedExtra).
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
