// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/hart.hpp"

namespace mebots::soc {

/// Where a load or store of the inner loop goes; both null = not fast RAM, take the hart's slow path.
struct RamAccess {
  std::uint8_t* data = nullptr;
  std::uint8_t* marks = nullptr;  // of the first word that the bytes touch
};

/// Finds the bytes of an access in the two fast regions and adds what it waits for: the way there, and the bank when
/// others use it too. Bytes across two words are two bus accesses, each with its wait; the extra cycle of the second
/// one (kMisalignedExtra) is left to the caller. Every handler that loads or stores goes through here.
template <unsigned Size>
[[gnu::always_inline]] inline RamAccess ram_access(Execution& e, const Instruction* at, std::uint32_t address) {
  const auto* ram = &e.ram[0];
  auto offset = address - ram->base;
  if (offset >= ram->span) [[unlikely]] {
    ram = &e.ram[1];
    offset = address - ram->base;
    if (offset >= ram->span) return {};
    ++e.far_accesses;
  }
  e.extra_cycles += ram->wait_cycles;
  if (ram->banks != nullptr) [[unlikely]]
    e.extra_cycles += ram->banks->claim(e.hart->cycle_of(at), address);
  if constexpr (Size > 1) {
    if (crosses_word(address, Size)) [[unlikely]] {
      e.extra_cycles += ram->wait_cycles;
      if (ram->banks != nullptr) e.extra_cycles += ram->banks->claim(e.hart->cycle_of(at) + 1, address + 4);
    }
  }
  return {ram->data + offset, ram->marks + offset / 4};
}

}  // namespace mebots::soc
