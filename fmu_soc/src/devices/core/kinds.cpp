// SPDX-License-Identifier: Apache-2.0
#include "devices/core/kinds.hpp"

#include "mebots/error.hpp"
#include "mebots/nearest_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

namespace mebots::soc {
namespace {

std::unique_ptr<Device> make_no_device(const BoardDevice& /*entry*/, ChipHost& /*host*/) {
  return nullptr;
}

}  // namespace
}  // namespace mebots::soc

// The cluster creates these devices itself.
MEBOTS_CHIP_KIND(event_unit, board::event_unit::kRegisters, make_no_device)
MEBOTS_CHIP_KIND(cluster_dma, board::cluster_dma::kRegisters, make_no_device)
MEBOTS_CHIP_KIND(gap8_cluster, {}, make_no_device)

namespace mebots::soc {
namespace kinds {

#define MEBOTS_KIND(NAME) extern const ChipKind kKind_##NAME;
#include "fmu_soc_kinds/kinds.inc"
#undef MEBOTS_KIND

}  // namespace kinds
namespace {

constexpr std::array kKinds{
#define MEBOTS_KIND(NAME) &kinds::kKind_##NAME,
#include "fmu_soc_kinds/kinds.inc"
#undef MEBOTS_KIND
};

void check_registers(const BoardDevice& entry, std::span<const board::RegisterName> expected) {
  const auto same = [](const BoardRegister& reg, const board::RegisterName& name) {
    return reg.name == name.name && reg.offset == name.offset;
  };
  if (expected.empty() || std::ranges::equal(entry.registers, expected, same)) return;
  throw Error(fmt::format(
      "board: the registers of device {} do not match those of its kind {}; copy them from configs/boards/ai_deck.json",
      entry.name, entry.kind));
}

}  // namespace

Kinds::Kinds(const BoardDescription& board, std::span<const std::filesystem::path> folders) {
  for (const auto& name : board.libraries) {
    auto taken = names();
    const auto& library = libraries_.emplace_back(kind_library_file(board, name, folders));
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
  for (const auto* kind : kKinds) names.emplace_back(kind->name);
  for (const auto& library : libraries_) {
    for (const auto& kind : library.kinds()) names.emplace_back(kind.name);
  }
  return names;
}

std::unique_ptr<Device> Kinds::make(const BoardDevice& entry, ChipHost& host) const {
  for (const auto* kind : kKinds) {
    if (kind->name != entry.kind) continue;
    check_registers(entry, kind->registers);
    return kind->make(entry, host);
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
