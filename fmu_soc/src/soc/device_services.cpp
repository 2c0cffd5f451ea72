// SPDX-License-Identifier: Apache-2.0
#include "soc/device_services.hpp"

#include "mebots/assert.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace mebots::soc {

PowerSettings DeviceServices::power_at_start() const {
  const auto* cluster = parts_.hardware.cluster();
  return {parts_.timeline.clock().hz(), cluster != nullptr ? cluster->clock_hz() : 0, parts_.power.voltage_mv(), 0, 0};
}

PartPort DeviceServices::part_at(const BoardDevice& entry, std::string_view place) {
  places_.push_back(fmt::format("{}.{}", entry.name, place));
  const auto& devices = parts_.hardware.board().devices;
  const auto found = std::ranges::find_if(
      devices, [this](const BoardDevice& part) { return part.part && part.part->attached_to == places_.back(); });
  if (found == devices.end()) return {};
  return PartPort(dynamic_cast<AttachedPart*>(parts_.devices.find(found->name)));
}

bool DeviceServices::write_console(std::uint8_t byte) {
  if (!parts_.listeners.console_byte) return false;
  parts_.listeners.console_byte(byte);
  return true;
}

int DeviceServices::read_console(Picoseconds now) {
  if (!parts_.listeners.console_input) return kEnded;
  return parts_.listeners.console_input(now, parts_.timeline.asleep());
}

double DeviceServices::load_energy_j(std::string_view load, Picoseconds now) const {
  if (load == kChipLoad) return parts_.power.energy_at(now).total_j();
  const auto* device = parts_.devices.find(load);
  MEBOTS_ASSERT(device != nullptr, "the reader of boards knows all loads");
  return device->energy_j(now);
}

}  // namespace mebots::soc
