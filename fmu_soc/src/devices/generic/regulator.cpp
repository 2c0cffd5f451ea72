// SPDX-License-Identifier: Apache-2.0
#include "devices/core/kinds.hpp"
#include "mebots/error.hpp"
#include "mebots/soc/device_kind.hpp"

#include <fmt/format.h>

#include <functional>
#include <string_view>
#include <utility>

namespace mebots::soc {
namespace {

/// Models a voltage regulator that supplies the chip and parts of the board. Its energy is the energy of its loads
/// divided by its efficiency.
class Regulator final : public Device {
 public:
  /// Returns the energy that a load has used up to `now` [J].
  using LoadEnergy = std::function<double(std::string_view load, Picoseconds now)>;

  Regulator(const BoardDevice& entry, LoadEnergy load_energy);

  bool load(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t& /*value*/) override { return false; }
  bool store(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t /*value*/) override { return false; }
  double energy_j(Picoseconds now) const override;
  void visit(state::Visitor& /*v*/) override {}

 private:
  const BoardDevice& entry_;
  LoadEnergy load_energy_;
};

}  // namespace

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
