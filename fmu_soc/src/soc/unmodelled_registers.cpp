// SPDX-License-Identifier: Apache-2.0
#include "soc/unmodelled_registers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace mebots::soc {
namespace {

/// Of the SoC, and the fabric controller's own at both of their addresses. Source: archi/chips/gap/memory_map.h.
struct Area {
  std::uint32_t base;
  std::uint32_t size;
};
constexpr std::array<Area, 3> kAreas{{{0x1A10'0000, 0x2'0000}, {0x0020'0000, 0x5000}, {0x1B20'0000, 0x5000}}};

}  // namespace

bool UnmodelledRegisters::are_at(std::uint32_t address) {
  return std::ranges::any_of(kAreas, [&](const Area& area) { return address - area.base < area.size; });
}

bool UnmodelledRegisters::is_new(std::uint32_t address) {
  return told_.insert(address).second;
}

std::string UnmodelledRegisters::text(std::uint32_t address, bool stores, std::string_view function,
                                      const BoardDevice* entry) const {
  const auto what =
      entry == nullptr
          ? std::string("no device of the board is there; one of its kind in C++, or a described one")
          : fmt::format("device {} of kind {} has no such register; one more in its C++, or a described one",
                        entry->name, entry->kind);
  return fmt::format("{} 0x{:08x}{}{}: {}, would answer. It {}", stores ? "store into" : "load from", address,
                     function.empty() ? "" : " in ", function, what, stores ? "is lost" : "reads 0");
}

}  // namespace mebots::soc
