// SPDX-License-Identifier: Apache-2.0
#include "devices/kinds.hpp"

#include "devices/camera.hpp"
#include "devices/console.hpp"
#include "devices/described_device.hpp"
#include "devices/regulator.hpp"
#include "devices/timer.hpp"
#include "fmu_soc_board/board.hpp"
#include "gap8_devices/advanced_timer.hpp"
#include "gap8_devices/efuse.hpp"
#include "gap8_devices/event_unit.hpp"
#include "gap8_devices/fll.hpp"
#include "gap8_devices/power_unit.hpp"
#include "gap8_devices/rtc.hpp"
#include "gap8_devices/soc_control.hpp"
#include "gap8_devices/soc_events.hpp"
#include "gap8_devices/stdout.hpp"
#include "gap8_devices/timer.hpp"
#include "gap8_devices/udma.hpp"

#include "mebots/error.hpp"
#include "mebots/nearest_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

namespace mebots::soc {
namespace {

using Registers = std::span<const board::RegisterName>;

/// A kind that comes with MEbots. To add one: a class in a file of its own, and its row below.
struct Row {
  std::string_view name;
  Registers registers;  // that an entry must have; none = those that it says
  std::unique_ptr<Device> (*make)(const BoardDevice& entry, ChipHost& host);
};

std::unique_ptr<Device> part_of_the_cluster(const BoardDevice& /*entry*/, ChipHost& /*host*/) {
  return nullptr;
}

template <typename T>
std::unique_ptr<Device> of_its_entry(const BoardDevice& entry, ChipHost& host) {
  return std::make_unique<T>(entry, host);
}

/// One that asks for clocks or voltage: what it does not say stays as the chip began.
template <typename T>
std::unique_ptr<Device> with_signals(const BoardDevice& entry, ChipHost& host) {
  if (!host.signals().power) host.signals().power = host.power_at_start();
  return std::make_unique<T>(entry, host, host.signals());
}

gap8_devices::EventUnit& event_unit_of(const BoardDevice& entry, ChipHost& host) {
  if (auto* port = host.find<gap8_devices::EventUnitPort>()) return port->unit();
  throw Error(fmt::format("board: device {} of kind {} needs one of kind {} in front of it", entry.name, entry.kind,
                          kGap8EventUnitKind));
}

constexpr std::array kRows{
    Row{"described", {}, of_its_entry<DescribedDevice>},
    Row{"console", board::console::kRegisters,
        [](const BoardDevice& /*entry*/, ChipHost& host) -> std::unique_ptr<Device> {
          return std::make_unique<Console>(host);
        }},
    Row{"timer", board::timer::kRegisters,
        [](const BoardDevice& /*entry*/, ChipHost& /*host*/) -> std::unique_ptr<Device> {
          return std::make_unique<Timer>();
        }},
    Row{"power_manager", board::power_manager::kRegisters,
        [](const BoardDevice& /*entry*/, ChipHost& host) -> std::unique_ptr<Device> {
          return std::make_unique<PowerManager>(host.chip(), host.power_at_start(), host.has_cluster());
        }},
    Row{"camera", board::camera::kRegisters, of_its_entry<Camera>},
    Row{"part",
        {},
        [](const BoardDevice& entry, ChipHost& /*host*/) -> std::unique_ptr<Device> {
          return std::make_unique<AttachedPart>(entry);
        }},
    Row{"regulator",
        {},
        [](const BoardDevice& entry, ChipHost& host) -> std::unique_ptr<Device> {
          return std::make_unique<Regulator>(
              entry, [&host](std::string_view load, Picoseconds now) { return host.load_energy_j(load, now); });
        }},
    Row{kGap8EventUnitKind,
        {},
        [](const BoardDevice& /*entry*/, ChipHost& host) -> std::unique_ptr<Device> {
          return std::make_unique<gap8_devices::EventUnitPort>(host.signals());
        }},
    Row{"gap8_event_unit_demux",
        {},
        [](const BoardDevice& entry, ChipHost& host) -> std::unique_ptr<Device> {
          return std::make_unique<gap8_devices::EventUnitDemux>(event_unit_of(entry, host));
        }},
    Row{"gap8_soc_events",
        {},
        [](const BoardDevice& entry, ChipHost& host) -> std::unique_ptr<Device> {
          auto& unit = event_unit_of(entry, host);
          return std::make_unique<gap8_devices::SocEvents>(host.signals(),
                                                           [&unit](unsigned event) { unit.queue_soc_event(event); });
        }},
    Row{"gap8_timer",
        {},
        [](const BoardDevice& /*entry*/, ChipHost& host) -> std::unique_ptr<Device> {
          return std::make_unique<gap8_devices::Timer>(host.signals(), [&host] { return host.clock_hz(); });
        }},
    Row{"gap8_advanced_timer",
        {},
        [](const BoardDevice& entry, ChipHost& host) -> std::unique_ptr<Device> {
          return std::make_unique<gap8_devices::AdvancedTimer>(
              host.signals(), [&host] { return host.clock_hz(); },
              [&host, name = entry.name](const char* text) { host.complain(fmt::format("{}: {}", name, text)); });
        }},
    Row{"gap8_rtc",
        {},
        [](const BoardDevice& /*entry*/, ChipHost& host) -> std::unique_ptr<Device> {
          return std::make_unique<gap8_devices::Rtc>(host.signals());
        }},
    Row{"gap8_efuse", {}, of_its_entry<gap8_devices::Efuse>},
    Row{"gap8_fll", {}, with_signals<gap8_devices::Fll>},
    Row{"gap8_soc_control", {}, with_signals<gap8_devices::SocControl>},
    Row{"gap8_power_unit", {}, with_signals<gap8_devices::PowerUnit>},
    Row{"gap8_udma",
        {},
        [](const BoardDevice& entry, ChipHost& host) -> std::unique_ptr<Device> {
          const auto image = host.flash();
          if (image.size() > gap8_devices::Udma::kFlashBytes) {
            throw Error(fmt::format("the flash image has {} bytes, the flash of device {} holds {}", image.size(),
                                    entry.name, gap8_devices::Udma::kFlashBytes));
          }
          return std::make_unique<gap8_devices::Udma>(
              entry, host, host.signals(), image, host.pictures(), [&host] { return host.clock_hz(); },
              gap8_devices::UdmaParts{{host.part_at(entry, "hyper_ram"), host.part_at(entry, "hyper_flash"),
                                       host.part_at(entry, "hyper_pads")},
                                      host.part_at(entry, "camera")});
        }},
    Row{"gap8_stdout",
        {},
        [](const BoardDevice& /*entry*/, ChipHost& host) -> std::unique_ptr<Device> {
          return std::make_unique<gap8_devices::Stdout>(host);
        }},
    Row{kEventUnitKind, board::event_unit::kRegisters, part_of_the_cluster},
    Row{kClusterDmaKind, board::cluster_dma::kRegisters, part_of_the_cluster},
    Row{kGap8ClusterKind, {}, part_of_the_cluster},
};

void check_registers(const BoardDevice& entry, Registers expected) {
  const auto same = [](const BoardRegister& reg, const board::RegisterName& name) {
    return reg.name == name.name && reg.offset == name.offset;
  };
  if (expected.empty() || std::ranges::equal(entry.registers, expected, same)) return;
  throw Error(fmt::format(
      "board: the registers of device {} are not those of its kind {}; take them from configs/boards/ai_deck.json",
      entry.name, entry.kind));
}

}  // namespace

Kinds::Kinds(const BoardDescription& board, std::span<const std::filesystem::path> folders) {
  for (const auto& name : board.libraries) {
    auto taken = names();
    const auto& library = libraries_.emplace_back(find_kind_library(board, name, folders));
    for (const auto& kind : library.kinds()) {
      if (std::ranges::find(taken, kind.name) != taken.end()) {
        throw Error(ErrorCode::duplicate_name, fmt::format("{}: there is a kind '{}' already; give it another name",
                                                           library.path().string(), kind.name));
      }
      taken.emplace_back(kind.name);
    }
  }
}

std::vector<std::string> Kinds::names() const {
  std::vector<std::string> names;
  for (const auto& row : kRows) names.emplace_back(row.name);
  for (const auto& library : libraries_) {
    for (const auto& kind : library.kinds()) names.emplace_back(kind.name);
  }
  return names;
}

std::unique_ptr<Device> Kinds::make(const BoardDevice& entry, ChipHost& host) const {
  for (const auto& row : kRows) {
    if (row.name != entry.kind) continue;
    check_registers(entry, row.registers);
    return row.make(entry, host);
  }
  for (const auto& library : libraries_) {
    for (const auto& kind : library.kinds()) {
      if (kind.name == entry.kind) return kind.make(entry, host);
    }
  }
  throw Error(
      ErrorCode::unknown_name,
      fmt::format("board: device {}: the kind '{}' is unknown. {} A kind of your own comes from a shared library "
                  "that the board names under 'libraries' (mebots-boardgen --skeleton begins its source)",
                  entry.name, entry.kind, suggest(entry.kind, names())));
}

}  // namespace mebots::soc
