// SPDX-License-Identifier: Apache-2.0
#include "devices/generic/regulator.hpp"

#include "devices/core/kinds.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

namespace mebots::soc {

Regulator::Regulator(const BoardDevice& entry, LoadEnergy load_energy)
    : entry_(entry), load_energy_(std::move(load_energy)) {
  if (entry.regulator) return;
  throw Error(
      ErrorCode::missing_key,
      fmt::format("board: device {} of kind {} needs the key 'regulator', and no address", entry.name, entry.kind));
}

double Regulator::energy_j(Picoseconds now) const {
  double loads_j = 0;
  for (const auto& load : entry_.regulator->loads) loads_j += load_energy_(load, now);
  return loads_j / entry_.regulator->efficiency;
}

}  // namespace mebots::soc

MEBOTS_CHIP_KIND(regulator, {}, [](const BoardDevice& entry, ChipHost& host) -> std::unique_ptr<Device> {
  return std::make_unique<Regulator>(
      entry, [&host](std::string_view load, Picoseconds now) { return host.load_energy_j(load, now); });
})
