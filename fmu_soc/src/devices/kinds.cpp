// SPDX-License-Identifier: Apache-2.0
#include "devices/kinds.hpp"

#include "devices/camera.hpp"
#include "devices/console.hpp"
#include "devices/described_device.hpp"
#include "devices/timer.hpp"
#include "fmu_soc_board/board.hpp"

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
    Row{kEventUnitKind, board::event_unit::kRegisters, part_of_the_cluster},
    Row{kClusterDmaKind, board::cluster_dma::kRegisters, part_of_the_cluster},
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
  std::vector<std::string_view> taken;
  for (const auto& row : kRows) taken.push_back(row.name);
  for (const auto& name : board.libraries) {
    const auto& library = libraries_.emplace_back(find_kind_library(board, name, folders));
    for (const auto& kind : library.kinds()) {
      if (std::ranges::find(taken, kind.name) != taken.end()) {
        throw Error(ErrorCode::duplicate_name, fmt::format("{}: there is a kind '{}' already; give it another name",
                                                           library.path().string(), kind.name));
      }
      taken.push_back(kind.name);
    }
  }
}

std::unique_ptr<Device> Kinds::make(const BoardDevice& entry, ChipHost& host) const {
  std::vector<std::string> known;
  for (const auto& row : kRows) {
    if (row.name == entry.kind) {
      check_registers(entry, row.registers);
      return row.make(entry, host);
    }
    known.emplace_back(row.name);
  }
  for (const auto& library : libraries_) {
    for (const auto& kind : library.kinds()) {
      if (kind.name == entry.kind) return kind.make(entry, host);
      known.emplace_back(kind.name);
    }
  }
  throw Error(
      ErrorCode::unknown_name,
      fmt::format("board: device {}: the kind '{}' is unknown. {} A kind of your own comes from a shared library "
                  "that the board names under 'libraries' (mebots-boardgen --skeleton begins its source)",
                  entry.name, entry.kind, suggest(entry.kind, known)));
}

}  // namespace mebots::soc
